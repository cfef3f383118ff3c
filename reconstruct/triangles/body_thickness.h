#pragma once

#include <cstdint>
#include <vector>

#include "common/context.h"
#include "reconstruct/triangles/triangle_tree.h"

namespace umtet {

/// Distances along the normal to the sheets on both sides; infinite where there is none.
struct FacingSheets {
  double body, gap;  ///< through the body, and outside of it; model units
};

/// How far it is from places on triangles to the sheets on the other side, by a ray along the normal: through the body
/// and, outside, to the sheet that faces it.
///
/// A sheet that meets the triangle in a ridge or a notch does not count, where the two are all that is there: a wedge
/// is as thin as one likes near its ridge, and no edge length shows more of it than another. Its planes meet at the
/// distance t / tan(angle), which is on the surface then.
///
/// @param points  each on the triangle of `faces` beside it
/// @param limit   distances are looked for up to here, model units; farther sheets count as infinite
/// \pre triangles look outward. Does not depend on threads. \throw Cancelled
std::vector<FacingSheets> facing_sheets(const TriangleMesh& mesh, const TriangleTree& tree,
                                        const std::vector<Vec3>& points, const std::vector<std::uint32_t>& faces,
                                        double limit, const Context& context = {});

/// The nearer of both for each place.
std::vector<double> sheet_thickness(const TriangleMesh& mesh, const TriangleTree& tree, const std::vector<Vec3>& points,
                                    const std::vector<std::uint32_t>& faces, double limit, const Context& context = {});

/// The thickness that this share of the values falls below; infinite where fewer are finite.
double thin_share_of(std::vector<double> thickness, double share);

}  // namespace umtet
