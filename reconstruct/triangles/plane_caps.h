#pragma once

#include <cstddef>
#include <vector>

#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

/// A planar cap that closes an opening of a surface.
struct PlaneCap {
  Vec3 centre = Vec3::Zero(), normal = Vec3::Zero();  ///< centre of the rim; normal outward, unit
  double area = 0;                                    ///< model units^2
  double off_plane = 0;                               ///< maximum distance of the rim from the plane, model units
  std::size_t n_triangles = 0;                        ///< number of triangles of the cap
};

/// Closes openings with a plane rim, such as an inlet or outlet of a fluid domain. Each is closed by triangles between
/// the corners of its rim. They are appended, cap by cap.
///
/// A rim is a chain of edges with one triangle each. It is closed if it is plane to a thousandth of its width, encloses
/// more than a crack, and the surface meets it at about a right angle, flares out, or continues in its plane. Where the
/// surface bends together, as around a hole in a ball, the opening stays, because the missing part is not plane
/// (closing.h). A sheet that is the only surface inside of its rim stays, too.
///
/// @param weld_distance  corners closer than this are identified (face_patches.h)
/// \pre triangles are oriented outward. The new triangles have label 0. Cost: O(n log n), and the square of the corners
/// of a rim.
std::vector<PlaneCap> cap_plane_rims(TriangleMesh& mesh, double weld_distance);

}  // namespace umtet
