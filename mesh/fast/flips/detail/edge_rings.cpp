#include "mesh/fast/flips/detail/edge_rings.h"

#include <algorithm>
#include <array>

namespace umtet::detail {
namespace {

/// The other two vertices of a tet with the edge (a, b), so that (a, b, first, second) is positive.
std::pair<int, int> opposite_edge(const Tet& t, int a, int b) {
  // The even permutations of the corners.
  constexpr std::array<std::array<int, 4>, 12> kEven = {{{0, 1, 2, 3},
                                                         {0, 2, 3, 1},
                                                         {0, 3, 1, 2},
                                                         {1, 0, 3, 2},
                                                         {1, 2, 0, 3},
                                                         {1, 3, 2, 0},
                                                         {2, 0, 1, 3},
                                                         {2, 1, 3, 0},
                                                         {2, 3, 0, 1},
                                                         {3, 0, 2, 1},
                                                         {3, 1, 0, 2},
                                                         {3, 2, 1, 0}}};
  for (const auto& p : kEven)
    if (t[p[0]] == a && t[p[1]] == b) return {t[p[2]], t[p[3]]};
  return {-1, -1};
}

}  // namespace

Incidence::Incidence(std::size_t n_vertices, const std::vector<Tet>& C)
    : begin_(n_vertices + 1, 0), list_of_(n_vertices, -1) {
  for (const Tet& t : C)
    for (const int v : t) ++begin_[v + 1];
  for (std::size_t v = 0; v < n_vertices; ++v) begin_[v + 1] += begin_[v];
  tets_.resize(4 * C.size());
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  for (std::size_t t = 0; t < C.size(); ++t)
    for (const int v : C[t]) tets_[next[v]++] = static_cast<int>(t);
}

std::vector<int>& Incidence::list(int v) {
  if (list_of_[v] < 0) {
    const std::span<const int> all = of(v);
    lists_.emplace_back(all.begin(), all.end());
    list_of_[v] = static_cast<int>(lists_.size()) - 1;
  }
  return lists_[list_of_[v]];
}

std::vector<int> ChangingMesh::tets_at(int a, int b) const {
  std::vector<int> tets;
  for (const int t : incidence.of(a))
    if (contains(C[t], b)) tets.push_back(t);
  return tets;
}

EdgeRing ChangingMesh::ring_of(int a, int b, const std::vector<int>& tets) const {
  EdgeRing ring;
  const auto n = static_cast<int>(tets.size());
  if (n < 1 || n > kMostRing) return ring;
  std::array<std::pair<int, int>, kMostRing> edge;
  for (int k = 0; k < n; ++k) edge[k] = opposite_edge(C[tets[k]], a, b);
  int first = 0;
  for (int k = 0; k < n; ++k) {
    const bool has_before =
        std::any_of(edge.begin(), edge.begin() + n, [&](auto e) { return e.second == edge[k].first; });
    if (!has_before) first = k;
  }
  ring.vertices = {edge[first].first};
  ring.tets = {tets[first]};
  int at = edge[first].second;
  for (int k = 1; k < n && at != ring.vertices.front(); ++k) {
    ring.vertices.push_back(at);
    const auto* next = std::find_if(edge.begin(), edge.begin() + n, [&](auto e) { return e.first == at; });
    if (next == edge.begin() + n) return {};
    ring.tets.push_back(tets[next - edge.begin()]);
    at = next->second;
  }
  ring.is_closed = at == ring.vertices.front();
  if (!ring.is_closed) ring.vertices.push_back(at);
  if (static_cast<int>(ring.vertices.size()) != n + (ring.is_closed ? 0 : 1)) return {};
  return ring;
}

double ChangingMesh::value_on_patch(const Triangle& f, const Vec3& x, Vec3& gradient) const {
  return stratified->strata->value(std::max(-1, patch_of(f[0], f[1], f[2])), x, &gradient);
}

bool ChangingMesh::is_on_interface(int a, int b) const {
  const std::vector<int> tets = tets_at(a, b);
  for (const int t : tets) {
    for (const int v : C[t]) {
      if (v == a || v == b) continue;
      const auto is_behind = [&](int s) { return s != t && region_of(s) == region_of(t) && contains(C[s], v); };
      if (std::none_of(tets.begin(), tets.end(), is_behind)) return true;
    }
  }
  return false;
}

bool ChangingMesh::are_neighbours(int a, int b) const {
  const std::span<const int> tets = incidence.of(a);
  return std::any_of(tets.begin(), tets.end(), [&](int t) { return contains(C[t], b); });
}

}  // namespace umtet::detail
