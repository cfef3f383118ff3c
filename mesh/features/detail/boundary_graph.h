#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "mesh/core/tet_mesh.h"

namespace umtet::detail {

using Edge = std::pair<int, int>;
inline Edge edge_of(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

/// The boundary as a graph of its vertices.
struct BoundaryGraph {
  struct Arc {
    int to, n_tets;
  };
  std::vector<int> vertices;           ///< ascending
  std::vector<std::vector<Arc>> arcs;  ///< per vertex of the mesh
  std::map<Edge, std::array<int, 2>> faces;

  BoundaryGraph(std::size_t n_vertices, const std::vector<Tet>& C, const std::vector<Triangle>& list)
      : arcs(n_vertices) {
    for (std::size_t f = 0; f < list.size(); ++f) {
      for (int k = 0; k < 3; ++k) {
        const auto [at, is_new] =
            faces.try_emplace(edge_of(list[f][k], list[f][(k + 1) % 3]), std::array{static_cast<int>(f), -1});
        if (!is_new) at->second[1] = static_cast<int>(f);
      }
    }
    std::vector<std::uint8_t> on_boundary(n_vertices, 0);
    for (const Triangle& f : list)
      for (const int v : f) on_boundary[v] = 1;
    for (std::size_t v = 0; v < n_vertices; ++v)
      if (on_boundary[v]) vertices.push_back(static_cast<int>(v));
    std::map<Edge, int> n_tets;
    for (const Tet& t : C)
      for (int i = 0; i < 4; ++i)
        for (int j = i + 1; j < 4; ++j)
          if (on_boundary[t[i]] && on_boundary[t[j]]) ++n_tets[edge_of(t[i], t[j])];
    for (const auto& [edge, f] : faces) {
      const int n = n_tets[edge];
      arcs[edge.first].push_back({edge.second, n});
      arcs[edge.second].push_back({edge.first, n});
    }
  }
  bool has_edge(int a, int b) const {
    return std::any_of(arcs[a].begin(), arcs[a].end(), [&](const Arc& arc) { return arc.to == b; });
  }
};

}  // namespace umtet::detail
