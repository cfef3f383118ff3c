#pragma once

#include <cstddef>

#include "common/context.h"
#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

/// Size and topology of what triangles bound.
struct TriangleBody {
  double volume = 0;              ///< enclosed, model units^3: sum over triangles of area vector . centroid / 3
  double area = 0;                ///< model units^2
  std::size_t n_pieces = 0;       ///< components of the surface, walls of cavities included
  long euler_characteristic = 0;  ///< of all of them together
  /// They wind around every place a whole number of times, so that `volume` is that of the body.
  bool is_closed = false;
  /// Each edge has two triangles of its piece, so that pieces and Euler number are those of the body's boundary.
  bool is_manifold = false;

  long genus() const { return static_cast<long>(n_pieces) - euler_characteristic / 2; }  ///< sum over pieces
};

/// Measures the triangles that bound a body, outward, as sample_body() makes them. Those with label 0 lie there with a
/// part of themselves only, as where bodies overlap: then neither volume nor topology is that of the body.
///
/// Triangles are one piece where they share an edge of two triangles (face_patches.h), so bodies that touch along an
/// edge or at a corner are several, and a corner counts once for each piece.
/// \pre every triangle has an area. \throw Cancelled. Cost: O(n log n)
TriangleBody measure_body(const TriangleMesh& boundary, const Context& context = {});

}  // namespace umtet
