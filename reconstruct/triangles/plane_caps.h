#pragma once

#include <cstddef>
#include <vector>

#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

/// An opening of a surface that has been closed by a plane.
struct PlaneCap {
  Vec3 centre = Vec3::Zero(), normal = Vec3::Zero();  ///< of the rim; outward, unit
  double area = 0;                                    ///< model units^2
  double off_plane = 0;                               ///< of the rim, at most, model units
  std::size_t n_triangles = 0;                        ///< that close it
};

/// Closes openings with a plane rim, as an inlet or outlet of a fluid domain has one: each by triangles between the
/// corners of its rim, which are appended, those of one cap after those of the other.
///
/// A rim is a chain of edges of one triangle each. It is closed where it is plane to a thousandth of its width,
/// encloses more than a crack, and where the surface comes down to it at about a right angle or flares out, or goes on
/// in its plane. Where the surface bends together, as around a hole in a ball, the opening stays: what is missing is no
/// plane (closing.h). A sheet that is all there is inside of its rim stays, too.
///
/// @param weld_distance  corners that are nearer are one (face_patches.h)
/// \pre triangles look outward. Labels of the new ones are 0. Cost: O(n log n), and the square of the corners of a rim.
std::vector<PlaneCap> cap_plane_rims(TriangleMesh& mesh, double weld_distance);

}  // namespace umtet
