#pragma once

#include <cstddef>

#include "common/context.h"
#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

/// What was found out about the sides of triangles, and done about it.
struct FaceSidesReport {
  std::size_t n_open_edges = 0;       ///< of one triangle: rims of gaps, and T-junctions
  std::size_t n_branching_edges = 0;  ///< of three and more: inner walls, bodies that touch
  std::size_t n_one_sided_edges = 0;  ///< where the sides of neighbours contradict each other all around
  double weld_distance = 0;           ///< within which corners counted as one; model units
  std::size_t n_patches = 0;          ///< that hang together through edges of two triangles
  std::size_t n_closed_patches = 0;
  std::size_t n_turned = 0;        ///< triangles that were turned over
  std::size_t n_cavities = 0;      ///< closed patches inside of others that look inward
  std::size_t n_inner_shells = 0;  ///< closed patches inside of others that look outward: solid
};

/// Turns triangles so that all look out of the body.
///
/// 1. Triangles that look to the other side than most of their patch (face_patches.h) are turned.
/// 2. A closed patch that encloses a negative volume is turned, unless it is inside of another: then it is a cavity. If
///    that is the largest, all is turned.
/// 3. An open patch is turned if the winding number of all others rises along its normals. Rounds, until none is; the
///    largest patch stays. If
///    there is no closed patch, and what they enclose together is negative, all is turned at the end.
///
/// \pre every triangle has an area. Does not depend on threads. \throw Cancelled. Cost: O(n log n)
FaceSidesReport orient_outward(TriangleMesh& mesh, const Context& context = {});

}  // namespace umtet
