#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common/vec3.h"
#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

/// Polylines in space, as files of feature edges contain them.
struct FeatureLines {
  std::vector<Vec3> points;                  ///< finite; model units
  std::vector<std::array<int, 2>> segments;  ///< indices into points; they may repeat
};

/// A place where lines do not run along the edges of triangles.
struct LineFault {
  int point;         ///< index of a point of FeatureLines
  std::string what;  ///< the fault of this point, with coordinates and distances
};

/// The edges of triangles along some lines.
struct FollowedLines {
  std::vector<std::array<int, 2>> lines;  ///< each side of a triangle on the lines once, by TriangleMesh::V
  std::size_t n_edges = 0;                ///< edges of the surface: sides of several triangles at one place are one
  std::size_t n_faults = 0;               ///< places where the lines leave the edges: what leads there is left out
  std::optional<LineFault> fault;         ///< the first of them
};

/// Finds the edges of triangles along which polylines run.
///
/// A point is at a vertex if its distance is within the tolerance
///
///     1e-6 D + 5e-6 c,   with the diagonal D and the largest coordinate c:
///
/// numbers in text often have six digits. Every polyline starts and ends at a vertex. Between two vertices it is a
/// chain of edges: all its points are within the tolerance of the chain, and all vertices of the chain within the
/// tolerance of the polyline. So either may have more points. Polylines may meet, cross and branch at vertices of
/// triangles only.
///
/// Cost: O(n log n), and for each edge that is followed the number of triangles around its vertex, 10 million in total.
FollowedLines follow_lines(const TriangleMesh& mesh, const FeatureLines& lines);

/// Returns the lines whose vertices have a new number. @param number  by vertex; -1: the vertex is dropped
std::vector<std::array<int, 2>> renumbered_lines(const std::vector<std::array<int, 2>>& lines,
                                                 const std::vector<int>& number);

}  // namespace umtet
