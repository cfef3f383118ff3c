#include "mesh/implicit/zero_set.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/disjoint_sets.h"
#include "common/polled_loops.h"
#include "mesh/core/asking_psi.h"
#include "mesh/implicit/cut_edges.h"

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

// Rows are worked on by stretches of so many nodes.
constexpr std::size_t kStretch = 64;
enum Signs : std::uint8_t { Outside = 1, Inside = 2, Both = 3 };

/// Nodes of one layer k: values, and the ids of the cut edges that start there.
struct Layer {
  std::vector<double> value;
  std::vector<std::uint8_t> signs;           ///< of the stretches of each row
  std::vector<std::array<int, 8>> cut_edge;  ///< towards corner 1..7, where that is cut
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
  std::uint8_t signs_around(int k, int last_k, int j, std::size_t stretch);
  /// Calls visit(i, j) for the nodes of a layer where psi may change sign on the way to the next node along each axis,
  /// up to layer last_k.
  template <class F>
  void for_each_node(int k, int last_k, const F& visit);
  void evaluate(int k);
  void find_cut_edges(int k, Directions directions);
  void join_node(int i, int j, int k, unsigned signs);
  void join_tet(int i, int j, int k, const std::array<int, 4>& corner, unsigned signs);
  void join_layer(int k);

  ImplicitFunctionRef psi_;
  Eigen::AlignedBox3d box_;
  const Context& context_;
  const FarFromZero& far_;
  std::array<int, 3> n_{};
  std::array<double, 3> h_{};
  std::size_t per_row_ = 0;  ///< stretches
  std::array<Layer, 2> layers_;
  std::vector<CutEdge> edges_;
  DisjointSets surface_;
  std::size_t n_not_finite_ = 0;
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
  per_row_ = (static_cast<std::size_t>(n_[0]) + kStretch) / kStretch;
  for (Layer& l : layers_) {
    l.value.resize(static_cast<std::size_t>(nodes));
    l.signs.resize(per_row_ * (n_[1] + 1));
    l.cut_edge.resize(l.value.size());
  }
}

/// Of a stretch and the next ones along each axis.
std::uint8_t Sweep::signs_around(int k, int last_k, int j, std::size_t stretch) {
  std::uint8_t signs = 0;
  for (int kk = k; kk <= std::min(last_k, n_[2]); ++kk) {
    for (int jj = j; jj <= std::min(j + 1, n_[1]); ++jj) {
      for (std::size_t s = stretch; s < std::min(stretch + 2, per_row_); ++s) {
        signs |= layer(kk).signs[static_cast<std::size_t>(jj) * per_row_ + s];
      }
    }
  }
  return signs;
}

template <class F>
void Sweep::for_each_node(int k, int last_k, const F& visit) {
  const int per_poll = std::max(1, static_cast<int>(kValuesPerPoll) / (n_[0] + 1));
  for (int j = 0; j <= n_[1]; ++j) {
    if (j % per_poll == 0) context_.poll();  // rows take some microseconds, too few to poll at each
    for (std::size_t s = 0; s < per_row_; ++s) {
      if (signs_around(k, last_k, j, s) != Both) continue;
      const auto first = static_cast<int>(s * kStretch);
      for (int i = first; i <= std::min(n_[0], first + static_cast<int>(kStretch) - 1); ++i) visit(i, j);
    }
  }
}

void Sweep::evaluate(int k) {
  std::vector<double>& value = layer(k).value;
  const std::size_t row = static_cast<std::size_t>(n_[0]) + 1;
  const bool in_blocks = psi_.side_by_side() && !far_;
  if (in_blocks) {
    const auto point = [&](std::size_t at) { return node(static_cast<int>(at % row), static_cast<int>(at / row), k); };
    take_in_blocks(psi_, value.size(), context_, point, [&](std::size_t at, double psi) { value[at] = psi; });
  }
  std::atomic<std::size_t> n_not_finite = 0;
  polled_parallel_for(per_row_ * (n_[1] + 1), kValuesPerPoll / kStretch, context_, [&](std::size_t s) {
    const int j = static_cast<int>(s / per_row_);
    const std::size_t first = s % per_row_ * kStretch, last = std::min(row, first + kStretch);
    std::uint8_t signs = 0;
    double before = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t i = first; i < last; ++i) {
      const Vec3 x = node(static_cast<int>(i), j, k);
      // A node that is far from any zero takes its sign from the one before.
      const bool known = far_ && std::isfinite(before) && far_(x);
      const double asked = known ? 0 : in_blocks ? value[j * row + i] : psi_.value(x);
      const double v = before = !known ? asked : before < 0 ? -kFarValue : kFarValue;
      if (!std::isfinite(v)) ++n_not_finite;
      value[j * row + i] = std::isfinite(v) ? v : std::numeric_limits<double>::max();
      signs |= v < 0 && std::isfinite(v) ? Inside : Outside;
    }
    layer(k).signs[s] = signs;
  });
  n_not_finite_ += n_not_finite;
}

void Sweep::find_cut_edges(int k, Directions directions) {
  for_each_node(k, directions.first == kUpward.first ? k + 1 : k, [&](int i, int j) {
    std::array<int, 8>& ids = layer(k).cut_edge[index(i, j)];
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
  for (int m = 0; m < n; ++m) {
    surface_.unite(ring[0], ring[m]);
    edges_[ring[m]].area += area / n;
  }
  edges_[ring[0]].faces_minus_edges2 += 2;
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
    edges_[cut_edge(i, j, k, odd, other)].faces_minus_edges2 -= 2;
  }
  if (!exists(i, j, k, 7)) return;
  for (const auto& [a, b] : kTets) join_tet(i, j, k, {0, a, b, 7}, signs);
}

void Sweep::join_layer(int k) {
  for_each_node(k, k + 1, [&](int i, int j) {
    unsigned signs = 0, known = 0;
    for (int c = 0; c < 8; ++c) {
      if (!exists(i, j, k, c)) continue;
      known |= 1u << c;
      signs |= static_cast<unsigned>(inside(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2))) << c;
    }
    if (signs != 0 && signs != known) join_node(i, j, k, signs);
  });
}

ZeroSetTopology Sweep::run() {
  evaluate(0);
  find_cut_edges(0, kInPlane);
  for (int k = 0; k < n_[2]; ++k) {
    evaluate(k + 1);
    find_cut_edges(k, kUpward);
    find_cut_edges(k + 1, kInPlane);
    join_layer(k);
  }
  join_layer(n_[2]);  // the triangles that lie in the top wall

  ZeroSetTopology result = topology_of(edges_, surface_);
  result.spacing = *std::max_element(h_.begin(), h_.end());
  result.n_not_finite = n_not_finite_;
  return result;
}

}  // namespace

ZeroSetTopology zero_set_topology(ImplicitFunctionRef psi, const Eigen::AlignedBox3d& box, double spacing,
                                  const Context& context, const FarFromZero& far) {
  return Sweep(psi, box, spacing, context, far).run();
}

}  // namespace umtet
