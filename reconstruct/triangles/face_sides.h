#pragma once

#include <cstddef>

#include "common/context.h"
#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

/// Report on the orientation of triangles.
struct FaceSidesReport {
  std::size_t n_open_edges = 0;       ///< edges of one triangle: rims of gaps, and T-junctions
  std::size_t n_branching_edges = 0;  ///< edges of three and more triangles: inner walls, touching bodies
  std::size_t n_one_sided_edges = 0;  ///< edges where the orientations of neighbours contradict each other all around
  double weld_distance = 0;           ///< corners closer than this were identified; model units
  std::size_t n_patches = 0;          ///< patches connected through edges of two triangles
  std::size_t n_closed_patches = 0;
  std::size_t n_turned = 0;        ///< triangles that were turned over
  std::size_t n_cavities = 0;      ///< closed patches inside of others, oriented inward
  std::size_t n_inner_shells = 0;  ///< closed patches inside of others, oriented outward: solid
};

/// Orients triangles consistently, so that all face out of the body.
///
/// 1. Triangles that are oriented opposite to most of their patch (face_patches.h) are turned.
/// 2. A closed patch that encloses a negative volume is turned, unless it is inside of another; then it is a cavity. If
///    it is the largest patch, all triangles are turned.
/// 3. An open patch is turned if the winding number of all others increases along its normals. This is repeated until
///    none is turned; the largest patch is fixed. If there is no closed patch, and the patches together enclose a
///    negative volume, all triangles are turned at the end.
///
/// \pre every triangle has an area. The result does not depend on threads. \throw Cancelled. Cost: O(n log n)
FaceSidesReport orient_outward(TriangleMesh& mesh, const Context& context = {});

}  // namespace umtet
