#include "mesh/implicit/cut_edges.h"

#include <algorithm>
#include <utility>

namespace umtet {

ZeroSetTopology topology_of(const std::vector<CutEdge>& edges, DisjointSets& surface) {
  ZeroSetTopology result;
  std::vector<ZeroSetComponent>& components = result.components;
  std::vector<int> piece(edges.size());
  std::vector<long> characteristic2;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const int root = surface.find(static_cast<int>(e));  // <= e
    if (root == static_cast<int>(e)) {
      piece[e] = static_cast<int>(components.size());
      components.emplace_back().seed = edges[e].point;
      characteristic2.push_back(0);
    } else {
      piece[e] = piece[root];
    }
    ZeroSetComponent& c = components[piece[e]];
    ++c.n_cut_edges;
    characteristic2[piece[e]] += 2 + edges[e].faces_minus_edges2;
    c.area += edges[e].area;
    c.box.extend(edges[e].point);
    if (edges[e].on_wall) c.closed = false;
  }
  std::vector<std::size_t> next(components.size());
  std::size_t n_points = 0;
  for (std::size_t n = 0; n < components.size(); ++n) {
    ZeroSetComponent& c = components[n];
    c.euler_characteristic = characteristic2[n] / 2;
    c.genus = (2 - c.euler_characteristic) / 2;
    result.euler_characteristic += c.euler_characteristic;
    next[n] = c.first_cut_point = std::exchange(n_points, n_points + c.n_cut_edges);
  }
  result.cut_points.resize(edges.size());
  result.cut_areas.resize(edges.size());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const std::size_t at = next[piece[e]]++;
    result.cut_points[at] = edges[e].point;
    result.cut_areas[at] = edges[e].area;
  }
  std::stable_sort(components.begin(), components.end(), [](const auto& x, const auto& y) { return x.area > y.area; });
  return result;
}

}  // namespace umtet
