#include "reconstruct/cloud/detail/kd_tree.h"

#include <oneapi/tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <utility>

namespace umtet::detail {
namespace {

// Points a leaf; the time of a search hardly depends on it.
constexpr std::uint32_t kLeaf = 16;
// Points whose part of the tree one thread builds: some 500 us.
constexpr std::uint32_t kAlone = 4096;

std::array<double, 2> range(const std::vector<Vec3>& points, std::uint32_t first, std::uint32_t last,
                            std::uint32_t axis) {
  std::array<double, 2> found = {points[first][axis], points[first][axis]};
  for (std::uint32_t row = first + 1; row < last; ++row) {
    found[0] = std::min(found[0], points[row][axis]);
    found[1] = std::max(found[1], points[row][axis]);
  }
  return found;
}

}  // namespace

KdTree::KdTree(std::vector<Vec3> points, std::vector<std::uint32_t> numbers)
    : points_(std::move(points)), numbers_(std::move(numbers)), low_(points_.front()), high_(points_.front()) {
  for (const Vec3& x : points_) {
    low_ = low_.cwiseMin(x);
    high_ = high_.cwiseMax(x);
  }
  Box box{low_, high_};
  grow(0, static_cast<std::uint32_t>(points_.size()), box, nodes_);
}

/// @param box  a box of the points; becomes the least one
void KdTree::grow(std::uint32_t first, std::uint32_t last, Box& box, std::vector<Node>& nodes) {
  const std::size_t number = nodes.size();
  nodes.emplace_back();
  if (last - first <= kLeaf) {
    nodes[number].first = first;
    nodes[number].last = last;
    box = {points_[first], points_[first]};
    for (std::uint32_t row = first + 1; row < last; ++row) {
      box.low = box.low.cwiseMin(points_[row]);
      box.high = box.high.cwiseMax(points_[row]);
    }
    return;
  }
  std::uint32_t axis = 0;
  double cut = 0;
  const std::uint32_t middle = divide(first, last, box, axis, cut);
  Box left = box, right = box;
  left.high[axis] = cut;
  right.low[axis] = cut;
  std::size_t right_number = 0;
  if (last - first <= kAlone) {
    grow(first, middle, left, nodes);
    right_number = nodes.size();
    grow(middle, last, right, nodes);
  } else {
    std::vector<Node> of_left, of_right;
    tbb::parallel_invoke([&] { grow(first, middle, left, of_left); }, [&] { grow(middle, last, right, of_right); });
    nodes.reserve(nodes.size() + of_left.size() + of_right.size());
    nodes.insert(nodes.end(), of_left.begin(), of_left.end());
    right_number = nodes.size();
    nodes.insert(nodes.end(), of_right.begin(), of_right.end());
  }
  Node& node = nodes[number];
  node.axis = axis;
  node.right = static_cast<std::uint32_t>(right_number - number);
  node.low = left.high[axis];
  node.high = right.low[axis];
  box = {left.low.cwiseMin(right.low), left.high.cwiseMax(right.high)};
}

/// Cuts the longest axis in the middle of its points.
/// @param box  of the points, and perhaps more
/// @return where the right part begins: neither is empty
std::uint32_t KdTree::divide(std::uint32_t first, std::uint32_t last, const Box& box, std::uint32_t& axis,
                             double& cut) {
  const Vec3 sides = box.high - box.low;
  axis = 0;
  for (std::uint32_t a = 1; a < 3; ++a)
    if (sides[a] > sides[axis]) axis = a;
  const std::uint32_t longest = axis;
  std::array<double, 2> extent = range(points_, first, last, axis);
  double length = extent[1] - extent[0];
  cut = (extent[0] + extent[1]) / 2;
  for (std::uint32_t a = 0; a < 3; ++a) {
    if (a == longest || !(sides[a] > length)) continue;
    extent = range(points_, first, last, a);
    if (!(extent[1] - extent[0] > length)) continue;
    length = extent[1] - extent[0];
    axis = a;
    cut = (extent[0] + extent[1]) / 2;
  }
  const auto [below, up_to] = part(first, last, axis, cut);
  const std::uint32_t half = first + (last - first) / 2;
  return below > half ? below : up_to < half ? up_to : half;
}

/// Points below the cut come first, then those on it.
/// @return where those on it begin and end
std::array<std::uint32_t, 2> KdTree::part(std::uint32_t first, std::uint32_t last, std::uint32_t axis, double cut) {
  const auto swap = [&](std::uint32_t a, std::uint32_t b) {
    std::swap(points_[a], points_[b]);
    std::swap(numbers_[a], numbers_[b]);
  };
  // Rows left .. right - 1 are still to be looked at.
  const auto sweep = [&](std::uint32_t left, auto&& goes_first) {
    std::uint32_t right = last;
    while (true) {
      while (left < right && goes_first(points_[left][axis])) ++left;
      while (left < right && !goes_first(points_[right - 1][axis])) --right;
      if (left >= right) return left;
      swap(left++, --right);
    }
  };
  const std::uint32_t below = sweep(first, [cut](double v) { return v < cut; });
  return {below, sweep(below, [cut](double v) { return v <= cut; })};
}

}  // namespace umtet::detail
