#include "mesh/patches/patch_curves.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "common/disjoint_sets.h"
#include "mesh/patches/detail/shared_edges.h"

namespace umtet {

std::vector<MeshCurve> curves_between(const std::vector<Triangle>& F, const std::vector<int>& face_patch) {
  struct Edge {
    std::array<int, 2> ends, patches;
  };
  std::vector<Edge> edges;
  std::map<int, std::set<std::array<int, 2>>> pairs;  // of patches, by vertex
  for (const auto& [v, w, face, other] : detail::shared_edges(F)) {
    if (face_patch[face] == face_patch[other]) continue;
    const auto [p, q] = std::minmax(face_patch[face], face_patch[other]);
    edges.push_back({{v, w}, {p, q}});
    for (const int end : {v, w}) pairs[end].insert({p, q});
  }
  std::sort(edges.begin(), edges.end(),
            [](const Edge& a, const Edge& b) { return std::tie(a.patches, a.ends) < std::tie(b.patches, b.ends); });
  DisjointSets connected(edges.size());
  std::map<std::pair<std::array<int, 2>, int>, int> first;  // edge of a pair of patches at a vertex
  for (std::size_t e = 0; e < edges.size(); ++e) {
    for (const int v : edges[e].ends) {
      if (pairs[v].size() > 1) continue;
      const auto [at, is_new] = first.try_emplace({edges[e].patches, v}, static_cast<int>(e));
      if (!is_new) connected.unite(static_cast<int>(e), at->second);
    }
  }
  std::map<int, std::size_t> number;
  std::vector<MeshCurve> curves;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto [at, is_new] = number.try_emplace(connected.find(static_cast<int>(e)), curves.size());
    if (is_new) {
      const int k = static_cast<int>(curves.size()) + 1;
      curves.push_back({{"curve_" + std::to_string(k), k}, {}});
    }
    curves[at->second].edges.push_back(edges[e].ends);
  }
  return curves;
}

}  // namespace umtet
