#pragma once

#include <cstddef>
#include <vector>

#include "body/body.h"
#include "body/fidelity/closed_hole.h"
#include "mesh/core/tet_mesh.h"

namespace umtet {

/// Every hole has a vertex that is at least this many support radii away from all samples, so the hole is at least
/// twelve spacings wide. If samples are distributed at random, a share of 2^-(k^2) of the surface is more than k
/// spacings away from all samples (k = 1 is the median distance of neighbours). So gaps of three spacings are frequent,
/// but a gap of six occurs once in 1e10 samples.
inline constexpr double kLeastHoleDepth = 2;
/// Maximum number of holes that a document lists. All holes are counted and exported.
inline constexpr std::size_t kListedHoles = 100;

/// The holes of a scan, on the boundary of its mesh.
struct ClosedHoles {
  std::vector<ClosedHole> holes;  ///< largest first
  std::vector<int> of_face;       ///< index into `holes` for each face; -1: the face belongs to no hole
};

/// Finds the parts of the boundary that a mesh closes without samples.
///
/// The surface is unsupported where every sample is farther than `radius`. A hole is a connected part of the
/// unsupported surface that reaches kLeastHoleDepth, extended by `radius` minus half a spacing, so that it ends just
/// before the samples around it. Distances are interpolated linearly on faces, so a rim is a smooth line across faces.
/// A hole consists of the faces whose centres are inside it, and of at least one face. (Surface within `radius` of the
/// samples of another sheet also counts as supported.)
///
/// @param radius   result of support_radius(); 0 if it is unknown: then no holes are found
/// @param support  distance from each vertex to the nearest sample; negative for vertices that are not on psi = 0
///                 (interior, walls)
/// @return  the holes, with centres in the coordinates of V. Up to rounding, the result does not depend on the order of
///          the faces.
/// Cost: O(n log n) if there are holes, otherwise O(n). \throw Cancelled
ClosedHoles find_closed_holes(const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                              const std::vector<double>& support, double radius, const Context& context = {});

/// Finds the holes of a mesh of the domain.
/// @param V      vertices, working coordinates
/// @param faces  boundary faces on psi = 0
/// \pre domain.has_samples() \throw Cancelled
ClosedHoles find_closed_holes(const Domain& domain, const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                              const Context& context = {});

/// Returns the support report of a mesh of the domain for its certificate. Centres are in model coordinates.
/// @param V      vertices, working coordinates
/// @param faces  boundary faces on psi = 0
/// \pre domain.has_samples() \throw Cancelled
SupportReport support_report(const Domain& domain, const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                             const Context& context = {});

}  // namespace umtet
