#include "mesh/implicit/zero_set.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/disjoint_sets.h"
#include "mesh/core/asking_psi.h"

namespace umtet {
namespace {

// Corners of a cube are numbers 0..7, bit k = step along axis k. Simplices of the Kuhn subdivision are chains
// 0 = c0 < c1 < ... of corners, each one a subset of the next, moved to every node of the grid. A chain from node v
// with c1, c2, c3 is counted at v, so every edge, triangle and tet of the grid is met exactly once.
// Corners 1..3 lie in the layer of the node, 4..7 in the next one.
struct Directions {
  int first, last;
};
constexpr Directions kInPlane{1, 4}, kUpward{4, 8};
constexpr std::array<std::pair<int, int>, 12> kTriangles = {
    {{1, 3}, {1, 5}, {1, 7}, {2, 3}, {2, 6}, {2, 7}, {4, 5}, {4, 6}, {4, 7}, {3, 7}, {5, 7}, {6, 7}}};
constexpr std::array<std::pair<int, int>, 6> kTets = {{{1, 3}, {1, 5}, {2, 3}, {2, 6}, {4, 5}, {4, 6}}};  // then 7

// At nodes without a cut edge, which is where psi is not evaluated, only the sign counts.
constexpr double kFarValue = 1;

/// What is known of a cut edge; sums of a component gather in its members until the end.
struct CutEdge {
  Vec3 point;
  double area = 0;
  std::int32_t faces_minus_edges = 0;  ///< cut tets - cut triangles counted here
  bool on_wall = false;
};

/// Nodes of one layer k: values, numbers of inside pieces, and the ids of the cut edges that start there.
struct Layer {
  std::vector<double> value;
  std::vector<int> inside_component;         ///< -1 outside
  std::vector<std::array<int, 8>> cut_edge;  ///< towards corner 1..7, -1 not cut
};

class Sweep {
 public:
  Sweep(ImplicitFunctionRef psi, const Eigen::AlignedBox3d& box, double spacing, const Context& context,
        const FarFromZero& far);
  ZeroSetTopology run();

 private:
  std::size_t index(int i, int j) const { return static_cast<std::size_t>(j) * (n_[0] + 1) + i; }
  Vec3 node(int i, int j, int k) const {
    return {box_.min().x() + i * h_[0], box_.min().y() + j * h_[1], box_.min().z() + k * h_[2]};
  }
  Layer& layer(int k) { return layers_[k & 1]; }
  bool inside(int i, int j, int k) { return layer(k).value[index(i, j)] < 0; }
  bool exists(int i, int j, int k, int corner) const {
    return i + (corner & 1) <= n_[0] && j + (corner >> 1 & 1) <= n_[1] && k + (corner >> 2) <= n_[2];
  }
  /// The cut edge between two corners of the cube at (i, j, k), one of them a subset of the other.
  int cut_edge(int i, int j, int k, int from, int to) {
    const int low = from & to, high = from | to;
    return layer(k + (low >> 2)).cut_edge[index(i + (low & 1), j + (low >> 1 & 1))][high & ~low];
  }
  /// Calls visit(j) for every row of a layer; rows take some microseconds, too few to poll at each.
  template <class F>
  void for_each_row(const F& visit);
  void evaluate(int k);
  void evaluate_by_threads(int k);
  void find_inside_components(int k);
  void find_cut_edges(int k, Directions directions);
  void join_node(int i, int j, int k, unsigned signs);
  void join_tet(int i, int j, int k, const std::array<int, 4>& corner, unsigned signs);
  void join_layer(int k);
  void gather(ZeroSetTopology& result);

  ImplicitFunctionRef psi_;
  Eigen::AlignedBox3d box_;
  const Context& context_;
  const FarFromZero& far_;
  std::array<int, 3> n_{};
  std::array<double, 3> h_{};
  std::array<Layer, 2> layers_;
  std::vector<CutEdge> edges_;
  DisjointSets surface_, inside_;
  std::size_t n_not_finite_ = 0;
  bool touches_box_ = false;
};

Sweep::Sweep(ImplicitFunctionRef psi, const Eigen::AlignedBox3d& box, double spacing, const Context& context,
             const FarFromZero& far)
    : psi_(psi), box_(box), context_(context), far_(far) {
  const Vec3 size = box.sizes();
  if (box.isEmpty() || !size.allFinite() || !(size.minCoeff() > 0))
    throw std::invalid_argument("box: must have a finite volume");
  if (!(spacing > 0)) throw std::invalid_argument("spacing = " + std::to_string(spacing) + ": must be > 0");
  for (int a = 0; a < 3; ++a) {
    // 1e-9: a box of n spacings gets n cells although its size was rounded.
    const double cells = std::max(1.0, std::ceil(size[a] / spacing * (1 - 1e-9)));
    if (!(cells <= 1e9)) throw std::length_error("spacing = " + std::to_string(spacing) + ": too small for the box");
    n_[a] = static_cast<int>(cells);
    h_[a] = size[a] / n_[a];
  }
  const double nodes = (n_[0] + 1.0) * (n_[1] + 1.0);
  if (nodes > std::numeric_limits<int>::max()) throw std::length_error("spacing: too small for the box");
  for (Layer& l : layers_) {
    l.value.resize(static_cast<std::size_t>(nodes));
    l.inside_component.resize(l.value.size());
    l.cut_edge.resize(l.value.size());
  }
}

template <class F>
void Sweep::for_each_row(const F& visit) {
  const int per_poll = std::max(1, static_cast<int>(kValuesPerPoll) / (n_[0] + 1));
  for (int j = 0; j <= n_[1]; ++j) {
    if (j % per_poll == 0) context_.poll();
    visit(j);
  }
}

void Sweep::evaluate_by_threads(int k) {
  std::vector<double>& value = layer(k).value;
  // Stretches of a row, because a node that is far from any zero takes its sign from the one before.
  constexpr std::size_t kStretch = 64;
  const std::size_t row = static_cast<std::size_t>(n_[0]) + 1, per_row = (row + kStretch - 1) / kStretch;
  polled_parallel_for(per_row * (n_[1] + 1), kValuesPerPoll / kStretch, context_, [&](std::size_t s) {
    const int j = static_cast<int>(s / per_row);
    const std::size_t first = s % per_row * kStretch, last = std::min(row, first + kStretch);
    for (std::size_t i = first; i < last; ++i) {
      const Vec3 x = node(static_cast<int>(i), j, k);
      const double before = i > first ? value[j * row + i - 1] : std::numeric_limits<double>::quiet_NaN();
      const bool known = far_ && std::isfinite(before) && far_(x);
      value[j * row + i] = !known ? psi_.value(x) : before < 0 ? -kFarValue : kFarValue;
    }
  });
}

void Sweep::evaluate(int k) {
  std::vector<double>& value = layer(k).value;
  const std::size_t row = static_cast<std::size_t>(n_[0]) + 1;
  if (psi_.side_by_side() && !far_) {
    const auto point = [&](std::size_t at) { return node(static_cast<int>(at % row), static_cast<int>(at / row), k); };
    take_in_blocks(psi_, value.size(), context_, point, [&](std::size_t at, double psi) { value[at] = psi; });
  } else {
    evaluate_by_threads(k);
  }
  for_each_row([&](int j) {
    for (int i = 0; i <= n_[0]; ++i) {
      double& v = value[index(i, j)];
      if (!std::isfinite(v)) {
        ++n_not_finite_;
        v = std::numeric_limits<double>::max();
      }
      const bool wall = i == 0 || j == 0 || k == 0 || i == n_[0] || j == n_[1] || k == n_[2];
      touches_box_ |= wall && v < 0;
    }
  });
}

/// Components of {psi < 0}: a node joins those of its seven predecessors along Kuhn edges that are inside.
void Sweep::find_inside_components(int k) {
  for_each_row([&](int j) {
    for (int i = 0; i <= n_[0]; ++i) {
      int& component = layer(k).inside_component[index(i, j)];
      component = -1;
      if (!inside(i, j, k)) continue;
      for (int c = 1; c < 8; ++c) {
        const int pi = i - (c & 1), pj = j - (c >> 1 & 1), pk = k - (c >> 2);
        if (pi < 0 || pj < 0 || pk < 0) continue;
        const int before = layer(pk).inside_component[index(pi, pj)];
        if (before < 0) continue;
        if (component < 0) {
          component = before;
        } else {
          inside_.unite(component, before);
        }
      }
      if (component < 0) component = inside_.add();
    }
  });
}

void Sweep::find_cut_edges(int k, Directions directions) {
  for_each_row([&](int j) {
    for (int i = 0; i <= n_[0]; ++i) {
      std::array<int, 8>& ids = layer(k).cut_edge[index(i, j)];
      std::fill(ids.begin() + directions.first, ids.begin() + directions.last, -1);
      const double v0 = layer(k).value[index(i, j)];
      for (int c = directions.first; c < directions.last; ++c) {
        if (!exists(i, j, k, c)) continue;
        const int ei = i + (c & 1), ej = j + (c >> 1 & 1), ek = k + (c >> 2);
        const double v1 = layer(ek).value[index(ei, ej)];
        if ((v0 < 0) == (v1 < 0)) continue;
        if (edges_.size() >= static_cast<std::size_t>(std::numeric_limits<int>::max())) {
          throw std::length_error("spacing: the zero set has more than 2^31 cut edges");
        }
        ids[c] = surface_.add();
        CutEdge edge;
        edge.point = node(i, j, k) + v0 / (v0 - v1) * (node(ei, ej, ek) - node(i, j, k));
        edge.on_wall = (i == ei && (i == 0 || i == n_[0])) || (j == ej && (j == 0 || j == n_[1])) ||
                       (k == ek && (k == 0 || k == n_[2]));
        edges_.push_back(edge);
      }
    }
  });
}

/// A cut tet carries a triangle (one node apart from three) or a quadrilateral (two and two).
void Sweep::join_tet(int i, int j, int k, const std::array<int, 4>& corner, unsigned signs) {
  std::array<int, 4> in{}, out{};
  int n_in = 0, n_out = 0;
  for (const int c : corner) (signs >> c & 1 ? in[n_in++] : out[n_out++]) = c;
  if (n_in == 0 || n_out == 0) return;
  std::array<int, 4> ring{};
  int n = 0;
  if (n_in == 2) {
    for (const auto& [a, b] : {std::pair{0, 0}, {0, 1}, {1, 1}, {1, 0}}) ring[n++] = cut_edge(i, j, k, in[a], out[b]);
  } else if (n_in == 1) {
    for (int b = 0; b < 3; ++b) ring[n++] = cut_edge(i, j, k, in[0], out[b]);
  } else {
    for (int a = 0; a < 3; ++a) ring[n++] = cut_edge(i, j, k, in[a], out[0]);
  }
  const Vec3& origin = edges_[ring[0]].point;
  double area = 0;
  for (int m = 1; m + 1 < n; ++m) {
    area += 0.5 * (edges_[ring[m]].point - origin).cross(edges_[ring[m + 1]].point - origin).norm();
  }
  for (int m = 1; m < n; ++m) surface_.unite(ring[0], ring[m]);
  edges_[ring[0]].area += area;
  ++edges_[ring[0]].faces_minus_edges;
}

/// The triangles and tets that start at a node; `signs` bit c: corner c is inside.
void Sweep::join_node(int i, int j, int k, unsigned signs) {
  for (const auto& [a, b] : kTriangles) {
    if (!exists(i, j, k, b)) continue;
    const bool s0 = signs & 1, sa = signs >> a & 1, sb = signs >> b & 1;
    if (s0 == sa && sa == sb) continue;
    // The node that differs from the other two is an end of a cut edge.
    const int odd = sa == sb ? 0 : s0 == sb ? a : b;
    const int other = odd == 0 ? a : 0;
    --edges_[cut_edge(i, j, k, odd, other)].faces_minus_edges;
  }
  if (!exists(i, j, k, 7)) return;
  for (const auto& [a, b] : kTets) join_tet(i, j, k, {0, a, b, 7}, signs);
}

void Sweep::gather(ZeroSetTopology& result) {
  std::vector<ZeroSetComponent>& components = result.components;
  std::vector<int> piece(edges_.size());
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const int root = surface_.find(static_cast<int>(e));  // <= e
    if (root == static_cast<int>(e)) {
      piece[e] = static_cast<int>(components.size());
      components.emplace_back().seed = edges_[e].point;
    } else {
      piece[e] = piece[root];
    }
    ZeroSetComponent& c = components[piece[e]];
    ++c.n_cut_edges;
    c.euler_characteristic += 1 + edges_[e].faces_minus_edges;
    c.area += edges_[e].area;
    c.box.extend(edges_[e].point);
    if (edges_[e].on_wall) c.closed = false;
  }
  std::vector<std::size_t> next(components.size());
  std::size_t n_points = 0;
  for (std::size_t n = 0; n < components.size(); ++n) {
    ZeroSetComponent& c = components[n];
    c.genus = (2 - c.euler_characteristic) / 2;
    result.euler_characteristic += c.euler_characteristic;
    next[n] = c.first_cut_point = std::exchange(n_points, n_points + c.n_cut_edges);
  }
  result.cut_points.resize(edges_.size());
  for (std::size_t e = 0; e < edges_.size(); ++e) result.cut_points[next[piece[e]]++] = edges_[e].point;
  std::stable_sort(components.begin(), components.end(), [](const auto& x, const auto& y) { return x.area > y.area; });
}

void Sweep::join_layer(int k) {
  for_each_row([&](int j) {
    for (int i = 0; i <= n_[0]; ++i) {
      unsigned signs = 0, known = 0;
      for (int c = 0; c < 8; ++c) {
        if (!exists(i, j, k, c)) continue;
        known |= 1u << c;
        signs |= static_cast<unsigned>(inside(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2))) << c;
      }
      if (signs != 0 && signs != known) join_node(i, j, k, signs);
    }
  });
}

ZeroSetTopology Sweep::run() {
  evaluate(0);
  find_inside_components(0);
  find_cut_edges(0, kInPlane);
  for (int k = 0; k < n_[2]; ++k) {
    evaluate(k + 1);
    find_inside_components(k + 1);
    find_cut_edges(k, kUpward);
    find_cut_edges(k + 1, kInPlane);
    join_layer(k);
  }
  join_layer(n_[2]);  // the triangles that lie in the top wall

  ZeroSetTopology result;
  result.n_cells = n_;
  result.spacing = *std::max_element(h_.begin(), h_.end());
  result.touches_box = touches_box_;
  result.n_not_finite = n_not_finite_;
  gather(result);
  for (std::size_t i = 0; i < inside_.size(); ++i) {
    result.n_inside_components += inside_.find(static_cast<int>(i)) == static_cast<int>(i);
  }
  return result;
}

}  // namespace

ZeroSetTopology zero_set_topology(ImplicitFunctionRef psi, const Eigen::AlignedBox3d& box, double spacing,
                                  const Context& context, const FarFromZero& far) {
  return Sweep(psi, box, spacing, context, far).run();
}

}  // namespace umtet
