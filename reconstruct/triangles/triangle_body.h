#pragma once

#include <cstddef>

#include "common/context.h"
#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

/// Size and topology of a body bounded by triangles.
struct TriangleBody {
  double volume = 0;              ///< enclosed volume, model units^3: sum over triangles of area vector . centroid / 3
  double area = 0;                ///< model units^2
  std::size_t n_pieces = 0;       ///< components of the surface, walls of cavities included
  long euler_characteristic = 0;  ///< sum over all components
  /// The winding number is a whole number everywhere, so that `volume` is the volume of the body.
  bool is_closed = false;
  /// Each edge has two triangles of its component, so that components and Euler characteristic equal those of the
  /// body's boundary.
  bool is_manifold = false;

  long genus() const { return static_cast<long>(n_pieces) - euler_characteristic / 2; }  ///< sum over components
};

/// Measures triangles that bound a body, outward, as made by sample_body(). Triangles with is_partly_inside() are on
/// the boundary only in part, for example where bodies overlap; then volume and topology differ from the body.
///
/// Triangles are in one component if they share an edge of two triangles (face_patches.h). Bodies that touch along an
/// edge or at a corner are therefore separate components, and a corner counts once per component.
/// \pre every triangle has an area. \throw Cancelled. Cost: O(n log n)
TriangleBody measure_body(const TriangleMesh& boundary, const Context& context = {});

}  // namespace umtet
