#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/vec3.h"
#include "mesh/regions/region_mesh.h"

namespace umtet::detail {

using Periods = std::array<int, 3>;

/// A corner of a tet on a torus: a copy of a vertex.
struct Corner {
  int vertex;
  Periods copy;
};

/// A mesh on a torus.
struct TorusMesh {
  Vec3 sides;
  std::vector<Vec3> V;
  std::vector<std::array<Corner, 4>> C;
  std::vector<int> region;
  std::vector<std::int64_t> background_vertex, background_tet;
  double h;

  Vec3 at(const Corner& c) const {
    return V[static_cast<std::size_t>(c.vertex)] + Vec3(c.copy[0], c.copy[1], c.copy[2]).cwiseProduct(sides);
  }
};

/// A torus cut open, with the corner that each vertex is.
struct CutMesh {
  RegionMesh mesh;              ///< background_vertex and background_tet are numbers in `corner` and in the torus
  std::vector<Corner> corner;   ///< per vertex
  std::vector<char> is_on_cut;  ///< per vertex: it has several copies
};

/// Cuts a torus open: each tet lies where its centroid is in the box whose lowest corner is `first`.
CutMesh cut_open(const TorusMesh& torus, const Vec3& first);

/// Cuts a torus open so that the boundary is a manifold: all tets at a pinched vertex become those of one copy of it.
/// @param is_manifold  receives whether that was possible
CutMesh cut_along_manifold(const TorusMesh& torus, const Vec3& first, bool& is_manifold);

/// Takes what has changed off the cut back to the torus.
void close(const CutMesh& cut, TorusMesh& torus);

}  // namespace umtet::detail
