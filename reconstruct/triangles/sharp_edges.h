#pragma once

#include <cstddef>
#include <vector>

#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

/// Parameters of find_sharp_edges(). The turn of an edge is the angle between the normals of its two triangles.
struct SharpEdgeParams {
  double sure_turn = 50;   ///< degrees: from this turn on an edge is sharp
  double least_turn = 15;  ///< degrees: below this turn an edge is smooth
  /// Degrees: a curve that turns as much at a vertex has a kink there, which is a corner, unless it turns alike at both
  /// neighbours, as the chords of an arc do. From sure_turn on it has a kink in any case.
  double kink_turn = 30;
  /// Curves with a loose end are noise if they are shorter than this share of the diagonal, ...
  double least_length = .04;
  std::size_t fewest_edges = 6;  ///< ... or if they have fewer edges
  bool by_turn = true;           ///< false: no edge is sharp because of its turn
  bool by_user = true;           ///< false: lines and borders of labels are not sharp because of that
};

/// A chain of sharp edges from corner to corner.
struct SharpCurve {
  /// The reason why it is sharp: the turn of any of its edges, else a line of the mesh, else a border of labels.
  enum class Reason { Turn, Line, Border };
  std::vector<int> vertices;  ///< in order; a closed curve repeats the first one at the end
  double length = 0;          ///< model units
  Reason reason = Reason::Turn;
  bool is_closed() const { return vertices.front() == vertices.back(); }
};

/// The sharp edges of a triangulated surface, as a graph of curves and corners, and the smooth patches between them.
struct SharpEdges {
  std::vector<SharpCurve> curves;
  std::vector<int> corners;        ///< vertices at which one curve, or three and more, end, or a curve has a kink
  std::vector<std::size_t> patch;  ///< by triangle
  std::size_t n_patches = 0;

  double length() const;                              ///< sum over the curves
  std::size_t n_curves_by(SharpCurve::Reason) const;  ///< number of the curves with this reason
};

/// Finds the edges at which a surface is not smooth, by the turn of its triangles; the lines of the mesh; and the edges
/// between triangles of different labels.
///
/// Between the two angles of the parameters, an edge is smooth if it is an edge between facets of a curved surface: on
/// both sides, the facet has another edge that runs alike, turns alike to the same side, and is at a comparable
/// distance. A facet is a connected set of coplanar triangles. Edges of three and more triangles are sharp.
///
/// A border of labels is left out if it is a staircase along the triangles of a scan: its edges have a mean length
/// below 2 % of the diagonal, and a quarter of its vertices are kinks to the other side than the vertex before. \pre
/// every triangle has an area, and triangles face outward. Vertices at one position are identified, see welded(). Cost:
/// O(n log n)
SharpEdges find_sharp_edges(const TriangleMesh& mesh, const SharpEdgeParams& params = {});

}  // namespace umtet
