#include "reconstruct/neighbour_tree.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace umtet {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Below this many leaves (some 100 us of work) a task costs more than it saves.
constexpr std::size_t kLeavesPerTask = 256;
constexpr double kLargest = std::numeric_limits<double>::max();
// Bounds come from the triangle inequality, whose terms are rounded a few times: a wider bound costs nothing.
constexpr double kRounding = 1 + 1e-12;

/// Puts the k nearest candidates in order, without a branch that depends on distances: a sort of these few dozen
/// mispredicts at every second step and takes twice as long. Equal distances stay in the order of candidates.
void select_nearest(std::vector<double>& distance2, std::size_t n, const std::uint32_t* points,
                    std::span<Neighbour> nearest) {
  constexpr std::uint32_t kFree = std::numeric_limits<std::uint32_t>::max();
  const std::size_t n_padded = (n + 7) / 8 * 8;
  for (std::size_t i = n; i < n_padded; ++i) distance2[i] = kInfinity;
  for (Neighbour& slot : nearest) slot.point = kFree;
  for (std::size_t i = 0; i < n; ++i) {
    const double d = distance2[i];
    std::int64_t n_nearer = 0;
    for (std::size_t j = 0; j < n_padded; ++j) n_nearer += distance2[j] < d ? 1 : 0;
    auto rank = static_cast<std::size_t>(n_nearer);
    while (rank < nearest.size() && nearest[rank].point != kFree) ++rank;  // equal distances
    if (rank < nearest.size()) nearest[rank] = {d, points[i]};
  }
}

}  // namespace

double NeighbourTree::Box::entry(const Vec3& x, const Vec3& inverse_d, double width) const {
  // An axis along which the ray does not move gives 0 * infinity where x is on the border: such a NaN must not cut.
  double enter = 0, leave = kInfinity;
  for (int axis = 0; axis < 3; ++axis) {
    double a = (low[axis] - width - x[axis]) * inverse_d[axis], b = (high[axis] + width - x[axis]) * inverse_d[axis];
    if (a > b) std::swap(a, b);
    if (a > enter) enter = a;
    if (b < leave) leave = b;
  }
  return enter <= leave ? enter : kInfinity;
}

NeighbourTree::NeighbourTree(const std::vector<Vec3>& points) {
  if (points.empty()) throw std::invalid_argument("a cloud without points has no neighbours");
  if (points.size() >= std::numeric_limits<std::uint32_t>::max() - 1)
    throw std::invalid_argument(std::to_string(points.size()) + " points: more than 32 bits can number");
  std::vector<Record> records(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) throw std::invalid_argument("points[" + std::to_string(i) + "] is not finite");
    records[i] = {points[i], static_cast<std::uint32_t>(i)};
  }
  n_leaves_ = (points.size() + kLeafPoints - 1) / kLeafPoints;
  boxes_.resize(2 * n_leaves_ - 1);
  ids_.resize(points.size());
  for (std::vector<double>* axis : {&x_, &y_, &z_}) axis->assign(n_leaves_ * kLeafPoints, kInfinity);
  build(records, root());
}

void NeighbourTree::build(std::vector<Record>& records, Node node) {
  const std::size_t first = node.first * kLeafPoints, end = leaf_end(node.end - 1);
  Box& box = boxes_[node.index];
  box = {records[first].x, records[first].x};
  for (std::size_t row = first + 1; row < end; ++row) {
    box.low = box.low.min(records[row].x.array());
    box.high = box.high.max(records[row].x.array());
  }
  if (node.is_leaf()) {
    for (std::size_t row = first; row < end; ++row) {
      const Record& r = records[row];
      x_[row] = r.x[0];
      y_[row] = r.x[1];
      z_[row] = r.x[2];
      ids_[row] = r.id;
    }
    return;
  }
  int axis = 0;
  (box.high - box.low).maxCoeff(&axis);
  const auto begin = records.begin();
  std::nth_element(begin + static_cast<std::ptrdiff_t>(first),
                   begin + static_cast<std::ptrdiff_t>(node.middle() * kLeafPoints),
                   begin + static_cast<std::ptrdiff_t>(end), [axis](const Record& a, const Record& b) {
                     return a.x[axis] < b.x[axis] || (a.x[axis] == b.x[axis] && a.id < b.id);
                   });
  const auto left = [&] { build(records, node.left()); };
  const auto right = [&] { build(records, node.right()); };
  if (node.end - node.first > kLeavesPerTask) {
    tbb::parallel_invoke(left, right);
  } else {
    left();
    right();
  }
}

std::size_t NeighbourTree::gather(std::size_t leaf, const Vec3& x, double bound2, double* distance2,
                                  std::uint32_t* points) const {
  const std::size_t first = leaf * kLeafPoints;
  std::array<double, kLeafPoints> d2;
  for (std::size_t j = 0; j < kLeafPoints; ++j) {  // one loop without branches: the compiler makes it vector code
    const double dx = x_[first + j] - x[0], dy = y_[first + j] - x[1], dz = z_[first + j] - x[2];
    d2[j] = dx * dx + dy * dy + dz * dz;
  }
  std::size_t n = 0;
  for (std::size_t j = 0; j < kLeafPoints; ++j) {
    distance2[n] = d2[j];
    points[n] = ids_[first + j];
    n += d2[j] <= bound2 ? 1 : 0;
  }
  return n;
}

void NeighbourTree::k_nearest(std::size_t leaf, std::size_t k, Neighbourhoods& found) const {
  k = std::min(k, size());
  const std::size_t first = leaf * kLeafPoints, n_queries = leaf_end(leaf) - first;
  found.points_ = points_of(leaf);
  found.k_ = k;
  found.found_.resize(kLeafPoints * k);
  if (k == 0) return;

  // The smallest node around the leaf with k points.
  std::array<Node, 40> path;
  std::size_t depth = 0;
  path[0] = root();
  while (!path[depth].is_leaf()) {
    path[depth + 1] = leaf < path[depth].middle() ? path[depth].left() : path[depth].right();
    ++depth;
  }
  const Box home = boxes_[path[depth].index];
  while (leaf_end(path[depth].end - 1) - path[depth].first * kLeafPoints < k) --depth;
  const Node start = path[depth];

  // The query in the middle goes first: it learns its distances from that node, and the others from it.
  const Vec3 middle = 0.5 * (home.low + home.high).matrix();
  std::size_t centre = 0;
  for (std::size_t q = 1; q < n_queries; ++q)
    if ((position(first + q) - middle).squaredNorm() < (position(first + centre) - middle).squaredNorm()) centre = q;
  found.reserve((start.end - start.first) * kLeafPoints);
  std::size_t n = 0;
  for (std::size_t other = start.first; other < start.end; ++other)
    n += gather(other, position(first + centre), kLargest, &found.distance2_[n], &found.candidates_[n]);
  std::nth_element(found.distance2_.begin(), found.distance2_.begin() + static_cast<std::ptrdiff_t>(k - 1),
                   found.distance2_.begin() + static_cast<std::ptrdiff_t>(n));
  std::array<double, kLeafPoints> reach;  // of the queries that are done: the distance of the k-th neighbour
  reach[0] = std::sqrt(found.distance2_[k - 1]);
  double farthest = 0;
  for (std::size_t q = 0; q < n_queries; ++q)
    farthest = std::max(farthest, (position(first + q) - position(first + centre)).norm());

  const double bound = kRounding * (reach[0] + farthest);
  found.leaves_.clear();
  Stack stack;
  std::size_t top = 0;
  stack[top++] = root();
  while (top > 0) {
    const Node node = stack[--top];
    if (boxes_[node.index].distance2(home) > bound * bound) continue;
    if (node.is_leaf()) {
      found.leaves_.push_back({node.index, node.first});
      continue;
    }
    stack[top++] = node.right();
    stack[top++] = node.left();
  }
  found.reserve(found.leaves_.size() * kLeafPoints);

  std::array<std::size_t, kLeafPoints> order;
  for (std::size_t q = 0; q < n_queries; ++q) order[q] = q;
  std::swap(order[0], order[centre]);
  for (std::size_t m = 0; m < n_queries; ++m) {
    const std::size_t q = order[m];
    const Vec3 x = position(first + q);
    double radius = reach[0];
    if (m > 0) radius += (position(first + order[0]) - x).norm();
    for (std::size_t done = 1; done < m; ++done)
      radius = std::min(radius, reach[done] + (position(first + order[done]) - x).norm());
    const double radius2 = kRounding * radius * radius;
    n = 0;
    for (const auto& other : found.leaves_)
      if (boxes_[other.node].distance2(x) <= radius2)
        n += gather(other.leaf, x, radius2, &found.distance2_[n], &found.candidates_[n]);
    const std::span<Neighbour> nearest(found.found_.data() + q * k, k);
    select_nearest(found.distance2_, n, found.candidates_.data(), nearest);
    reach[m] = std::sqrt(nearest.back().distance2);
  }
}

std::size_t NeighbourTree::count_within(const Vec3& x, double radius2, std::size_t limit) const {
  std::size_t count = 0;
  Stack stack;
  std::size_t top = 0;
  stack[top++] = root();
  while (top > 0 && count < limit) {
    const Node node = stack[--top];
    const Box& box = boxes_[node.index];
    if (box.distance2(x) > radius2) continue;
    const std::size_t first = node.first * kLeafPoints, end = leaf_end(node.end - 1);
    if (box.farthest2(x) <= radius2) {
      count += end - first;
    } else if (node.is_leaf()) {
      for (std::size_t row = first; row < end; ++row) count += (position(row) - x).squaredNorm() <= radius2 ? 1 : 0;
    } else {
      stack[top++] = node.right();
      stack[top++] = node.left();
    }
  }
  return std::min(count, limit);
}

void for_each_neighbourhood(const NeighbourTree& tree, std::size_t k,
                            const std::function<void(std::uint32_t, std::span<const Neighbour>)>& visit,
                            const std::vector<std::uint8_t>& done) {
  const auto is_open = [&](std::uint32_t i) { return done.empty() || done[i] == 0; };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, tree.n_leaves()),
                    [&](const tbb::blocked_range<std::size_t>& leaves) {
                      Neighbourhoods found;
                      for (std::size_t leaf = leaves.begin(); leaf != leaves.end(); ++leaf) {
                        const std::span<const std::uint32_t> points = tree.points_of(leaf);
                        if (std::none_of(points.begin(), points.end(), is_open)) continue;
                        tree.k_nearest(leaf, k, found);
                        for (std::size_t q = 0; q < points.size(); ++q)
                          if (is_open(points[q])) visit(points[q], found.of(q));
                      }
                    });
}

}  // namespace umtet
