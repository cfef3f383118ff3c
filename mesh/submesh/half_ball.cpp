#include "mesh/submesh/half_ball.h"

#include <algorithm>

#include "common/disjoint_sets.h"

namespace umtet {

bool HalfBall::operator()(std::int64_t v, const IdSet& inside) {
  list_triangles(v, inside);
  return triangles_.empty() || is_disc(inside);
}

void HalfBall::list_triangles(std::int64_t v, const IdSet& inside) {
  star_.clear();
  background_.star(v, star_);
  triangles_.clear();
  for (const std::int64_t t : star_) {
    const std::array<std::int64_t, 4> tet = background_.tet(t);
    if (std::none_of(tet.begin(), tet.end(), [&](std::int64_t w) { return inside.test(w); })) continue;
    std::array<std::int64_t, 3> triangle{};
    std::copy_if(tet.begin(), tet.end(), triangle.begin(), [v](std::int64_t w) { return w != v; });
    triangles_.push_back(triangle);
  }
}

/// A connected surface of Euler characteristic 1 whose rim is one closed path; an edge of a triangulated sphere or disc
/// has two triangles at most.
bool HalfBall::is_disc(const IdSet& inside) {
  edges_.clear();
  vertices_.clear();
  for (int t = 0; t < static_cast<int>(triangles_.size()); ++t) {
    const auto& triangle = triangles_[t];
    for (int k = 0; k < 3; ++k) {
      const std::int64_t a = triangle[k], b = triangle[(k + 1) % 3];
      edges_.push_back({{std::min(a, b), std::max(a, b)}, t});
      vertices_.push_back(a);
    }
  }
  std::sort(edges_.begin(), edges_.end());
  std::sort(vertices_.begin(), vertices_.end());
  vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
  rim_.clear();
  std::size_t n_edges = 0;
  for (std::size_t i = 0; i < edges_.size(); ++n_edges) {
    const Edge& edge = edges_[i].first;
    if (i + 1 < edges_.size() && edges_[i + 1].first == edge) {
      if (!inside.test(edge.low) && !inside.test(edge.high)) return false;  // a positive face with tets on both sides
      i += 2;
    } else {
      rim_.push_back(edge);
      ++i;
    }
  }
  return vertices_.size() + triangles_.size() == n_edges + 1 && is_one_cycle() && is_connected();
}

bool HalfBall::is_one_cycle() {
  if (rim_.empty()) return false;
  std::vector<std::pair<std::int64_t, std::int64_t>> next;  // both ways
  for (const Edge& e : rim_) {
    next.emplace_back(e.low, e.high);
    next.emplace_back(e.high, e.low);
  }
  std::sort(next.begin(), next.end());
  for (std::size_t i = 0; i < next.size(); i += 2) {
    const bool has_two = next[i + 1].first == next[i].first;
    if (!has_two || (i + 2 < next.size() && next[i + 2].first == next[i].first)) return false;
  }
  std::int64_t before = next.front().second, at = next.front().first;
  std::size_t length = 0;
  do {
    const auto first = std::lower_bound(next.begin(), next.end(), std::pair(at, std::int64_t{-1}));
    const std::int64_t on = first->second == before ? (first + 1)->second : first->second;
    before = at;
    at = on;
    ++length;
  } while (at != next.front().first);
  return length == rim_.size();
}

bool HalfBall::is_connected() {
  DisjointSets sets(triangles_.size());
  for (std::size_t i = 1; i < edges_.size(); ++i) {
    if (edges_[i].first == edges_[i - 1].first) sets.unite(edges_[i].second, edges_[i - 1].second);
  }
  for (std::size_t t = 1; t < triangles_.size(); ++t) {
    if (sets.find(static_cast<int>(t)) != sets.find(0)) return false;
  }
  return true;
}

}  // namespace umtet
