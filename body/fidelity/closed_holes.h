#pragma once

#include <cstddef>
#include <vector>

#include "body/body.h"
#include "body/fidelity/closed_hole.h"
#include "mesh/core/tet_mesh.h"

namespace umtet {

/// A hole has a vertex that is this many radii of support from every sample: it is twelve spacings wide. Where samples
/// lie at random, a share of 2^-(k^2) of the surface is k spacings from all of them (the median distance of neighbours
/// is the case k = 1): gaps of three spacings are everywhere, one of six takes 1e10 samples.
inline constexpr double kLeastHoleDepth = 2;
/// Holes that a document lists. All are counted and exported.
inline constexpr std::size_t kListedHoles = 100;

/// The holes of a scan, on the boundary of its mesh.
struct ClosedHoles {
  std::vector<ClosedHole> holes;  ///< largest first
  std::vector<int> of_face;       ///< of each face, into holes; -1: none
};

/// What a mesh closes without samples.
///
/// The surface is unsupported where every sample is farther than `radius`. A hole is a connected part of that, as deep
/// as kLeastHoleDepth, with what is within `radius`, less half a spacing, of it: so it ends just before the samples
/// around it. Distances are linear on faces: a rim is a smooth line across them. A hole has the faces whose centres are
/// inside it, at least one. (What is nearer than `radius` to the samples of another sheet has support.)
///
/// @param radius   of support_radius(); 0: nothing is known of it, and there are no holes
/// @param support  distance of each vertex to the nearest sample; negative where psi is not 0: inside, at walls
/// @return  centres in the coordinates of V. Up to rounding it does not depend on the order of the faces.
/// Cost: O(n log n) where there are holes, else O(n). \throw Cancelled
ClosedHoles find_closed_holes(const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                              const std::vector<double>& support, double radius, const Context& context = {});

/// Of the surface of a mesh of the domain: what its certificate says. Centres in model coordinates.
/// @param V      working coordinates
/// @param faces  on psi = 0
/// \pre domain.has_samples() \throw Cancelled
SupportReport support_report(const Domain& domain, const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                             const Context& context = {});

}  // namespace umtet
