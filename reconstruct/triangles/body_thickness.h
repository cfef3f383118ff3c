#pragma once

#include <cstdint>
#include <vector>

#include "common/context.h"
#include "reconstruct/triangles/triangle_tree.h"

namespace umtet {

/// Distances along the normal to the sheets on both sides; infinite if there is none.
struct FacingSheets {
  double body, gap;  ///< through the body, and outside of it; model units
};

/// Local thickness at positions on triangles, by a ray along the normal: through the body, and outside to the sheet
/// that faces it.
///
/// A sheet that meets the triangle in a ridge or a notch is ignored if the ray meets nothing else: a wedge is
/// arbitrarily thin near its ridge, and no edge length resolves more of it than another. Its planes meet at the
/// distance t / tan(angle), which is then on the surface.
///
/// @param points  each on the triangle with the same index in `faces`
/// @param limit   maximum search distance, model units; farther sheets count as infinite
/// \pre triangles are oriented outward. The result does not depend on threads. \throw Cancelled
std::vector<FacingSheets> facing_sheets(const TriangleMesh& mesh, const TriangleTree& tree,
                                        const std::vector<Vec3>& points, const std::vector<std::uint32_t>& faces,
                                        double limit, const Context& context = {});

/// The smaller of both distances for each position.
std::vector<double> sheet_thickness(const TriangleMesh& mesh, const TriangleTree& tree, const std::vector<Vec3>& points,
                                    const std::vector<std::uint32_t>& faces, double limit, const Context& context = {});

/// The thickness below which this fraction of the values lies; infinite if fewer are finite.
double thin_share_of(std::vector<double> thickness, double share);

}  // namespace umtet
