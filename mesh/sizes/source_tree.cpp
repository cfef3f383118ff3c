#include "mesh/sizes/source_tree.h"

#include <oneapi/tbb/parallel_invoke.h>
#include <oneapi/tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>

#include "common/polled_loops.h"

namespace umtet {
namespace {

// More sources in a leaf cost distances, fewer cost nodes.
constexpr std::size_t kMostInLeaf = 8;
constexpr std::size_t kWorthThreads = 1 << 13;
// A walk keeps one node of each depth; a tree of 2^40 leaves does not fit in memory.
constexpr std::size_t kDeepest = 48;
// The least is not looked for further where it cannot be less by more than this share. Half of it takes half as long
// again, and a mesh meets sizes to a factor of two.
constexpr double kSlack = .05;

/// Between the point or cube [low, high] and a box.
double distance(const Vec3& low, const Vec3& high, const Eigen::AlignedBox3d& box) {
  return (box.min() - high).cwiseMax(low - box.max()).cwiseMax(0).norm();
}

bool comes_before(const Vec3& a, const Vec3& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

}  // namespace

SourceTree::SourceTree(std::vector<SizeSource> sources, double grade) : grade_(grade), sources_(std::move(sources)) {
  if (sources_.empty()) return;
  std::size_t n_leaves = 1;
  while (n_leaves * kMostInLeaf < sources_.size()) n_leaves *= 2;
  first_leaf_ = n_leaves - 1;
  leaves_.resize(n_leaves);
  nodes_.resize(2 * n_leaves - 1);
  split(0, 0, sources_.size());
}

void SourceTree::split(std::size_t node, std::size_t begin, std::size_t end) {
  Node& own = nodes_[node];
  if (node >= first_leaf_) {
    leaves_[node - first_leaf_] = {begin, end};
    own.h = own.a = std::numeric_limits<double>::infinity();
    for (std::size_t k = begin; k < end; ++k) {
      own.box.extend(sources_[k].x);
      own.h = std::min(own.h, sources_[k].h);
      own.a = std::min(own.a, a_of(sources_[k]));
    }
    return;
  }
  Box box;
  for (std::size_t k = begin; k < end; ++k) box.extend(sources_[k].x);
  Eigen::Index axis = 0;
  if (begin < end) box.sizes().maxCoeff(&axis);
  const std::size_t middle = begin + (end - begin) / 2;
  const auto at = [&](std::size_t k) { return sources_.begin() + static_cast<std::ptrdiff_t>(k); };
  // A total order of what sources say, so that which half one is in does not depend on where it stood.
  std::nth_element(at(begin), at(middle), at(end), [axis](const SizeSource& a, const SizeSource& b) {
    if (a.x[axis] != b.x[axis]) return a.x[axis] < b.x[axis];
    if (a.x != b.x) return comes_before(a.x, b.x);
    return a.h != b.h ? a.h < b.h : a.radius < b.radius;
  });
  const auto left = [&] { split(2 * node + 1, begin, middle); };
  const auto right = [&] { split(2 * node + 2, middle, end); };
  if (end - begin > kWorthThreads) {
    tbb::parallel_invoke(left, right);
  } else {
    left();
    right();
  }
  const Node &l = nodes_[2 * node + 1], &r = nodes_[2 * node + 2];
  own = {l.box.merged(r.box), std::min(l.h, r.h), std::min(l.a, r.a)};
}

double SourceTree::bound(const Node& node, double distance) const {
  return std::max(node.h, node.a + grade_ * distance);
}

/// The lower bounds decide the order. What cannot be below (1 - kSlack) of the least so far is not looked into, but
/// counted with its bound.
template <class NodeBound, class SourceValue>
double SourceTree::least(const NodeBound& of_node, const SourceValue& of_source, double least, double most) const {
  if (nodes_.empty()) return most;
  struct Entry {
    std::size_t node;
    double bound;
  };
  Entry stack[kDeepest];
  int n = 0;
  double best = most, lowest_left_out = most;
  stack[n++] = {0, of_node(nodes_[0])};
  while (n > 0) {
    const Entry e = stack[--n];
    if (e.bound >= (1 - kSlack) * best || best <= least) {
      lowest_left_out = std::min(lowest_left_out, e.bound);
      continue;
    }
    if (e.node >= first_leaf_) {
      const Range range = leaves_[e.node - first_leaf_];
      for (std::size_t k = range.begin; k < range.end; ++k) best = std::min(best, of_source(sources_[k]));
      continue;
    }
    Entry near{2 * e.node + 1, of_node(nodes_[2 * e.node + 1])}, far{2 * e.node + 2, of_node(nodes_[2 * e.node + 2])};
    if (far.bound < near.bound) std::swap(near, far);
    stack[n++] = far;
    stack[n++] = near;
  }
  return std::min(best, lowest_left_out);
}

double SourceTree::at(const Vec3& x, double least, double most) const {
  return this->least([&](const Node& node) { return bound(node, distance(x, x, node.box)); },
                     [&](const SizeSource& s) { return std::max(s.h, a_of(s) + grade_ * (s.x - x).norm()); }, least,
                     most);
}

double SourceTree::least_in(const Vec3& centre, double half_width, double least, double most) const {
  const Vec3 low = centre - Vec3::Constant(half_width), high = centre + Vec3::Constant(half_width);
  return this->least([&](const Node& node) { return bound(node, distance(low, high, node.box)); },
                     [&](const SizeSource& s) {
                       return std::max(s.h, a_of(s) + grade_ * (s.x - high).cwiseMax(low - s.x).cwiseMax(0).norm());
                     },
                     least, most);
}

bool SourceTree::is_dominated(std::size_t k) const {
  const SizeSource& own = sources_[k];
  const double a = a_of(own);
  std::size_t stack[kDeepest];
  int n = 0;
  stack[n++] = 0;
  while (n > 0) {
    const std::size_t node = stack[--n];
    const Node& box = nodes_[node];
    if (box.h > own.h || box.a + grade_ * distance(own.x, own.x, box.box) > a) continue;
    if (node < first_leaf_) {
      stack[n++] = 2 * node + 2;
      stack[n++] = 2 * node + 1;
      continue;
    }
    const Range range = leaves_[node - first_leaf_];
    for (std::size_t i = range.begin; i < range.end; ++i) {
      const SizeSource& s = sources_[i];
      if (s.h > own.h || a_of(s) + grade_ * (s.x - own.x).norm() > a) continue;
      // Never two that rounding makes the same by each other.
      if (std::tuple(a_of(s), s.h, i) < std::tuple(a, own.h, k)) return true;
    }
  }
  return false;
}

std::vector<SizeSource> undominated(std::vector<SizeSource> sources, double grade, const Context& context) {
  const SourceTree tree(std::move(sources), grade);
  const std::vector<SizeSource>& all = tree.sources();
  std::vector<std::uint8_t> is_superfluous(all.size());
  polled_parallel_for(all.size(), kValuesPerPoll, context,
                      [&](std::size_t k) { is_superfluous[k] = tree.is_dominated(k) ? 1 : 0; });
  std::vector<SizeSource> left;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (!is_superfluous[k]) left.push_back(all[k]);
  }
  return left;
}

std::vector<SizeSource> thinned(std::vector<SizeSource> sources, double grade, double tolerance) {
  /// Two sources in one cell are at most tolerance h / grade apart.
  struct InCell {
    int level;
    std::array<double, 3> cell;
    double a;
    std::uint32_t source;
    auto place() const { return std::tie(level, cell); }
  };
  std::vector<InCell> order(sources.size());
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const SizeSource& s = sources[i];
    const int level = std::ilogb(tolerance * s.h / (std::sqrt(3.) * grade));
    const Vec3 cell = (s.x * std::ldexp(1, -level)).array().floor();
    order[i] = {level, {cell.x(), cell.y(), cell.z()}, s.h - grade * s.radius, static_cast<std::uint32_t>(i)};
  }
  tbb::parallel_sort(order.begin(), order.end(), [](const InCell& a, const InCell& b) {
    return std::tie(a.level, a.cell, a.a, a.source) < std::tie(b.level, b.cell, b.a, b.source);
  });
  std::vector<SizeSource> left;
  const InCell* kept = nullptr;
  for (const InCell& c : order) {
    const SizeSource& s = sources[c.source];
    if (kept && kept->place() == c.place()) {
      const double most = (1 + tolerance) * s.h;
      const SizeSource& k = sources[kept->source];
      if (k.h <= most && kept->a + grade * (k.x - s.x).norm() <= c.a + tolerance * s.h) continue;
    }
    kept = &c;
    left.push_back(s);
  }
  return left;
}

}  // namespace umtet
