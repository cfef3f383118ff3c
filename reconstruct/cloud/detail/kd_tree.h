#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/vec3.h"

namespace umtet::detail {

/// A k-d tree of points: the axis along which a node's points extend most is cut in the middle, and a place's own side
/// is walked first. Several threads build it; its shape does not depend on them.
class KdTree {
 public:
  /// @param points   finite, at least one
  /// @param numbers  one for each of them
  KdTree(std::vector<Vec3> points, std::vector<std::uint32_t> numbers);

  /// The points by leaves: those of a row and the next are near each other.
  const std::vector<Vec3>& points() const { return points_; }
  const std::vector<std::uint32_t>& numbers() const { return numbers_; }
  const Vec3& low() const { return low_; }
  const Vec3& high() const { return high_; }

  /// Calls found.add(distance2, row) for the points nearer than found.bound() squared, and some that are not: a leaf
  /// asks for the bound once, before its points. Boxes at exactly the bound are walked.
  template <class Found>
  void search(const Vec3& x, Found& found) const {
    Vec3 beyond = Vec3::Zero();  // squared distances to the box, by axes
    double distance2 = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double d = x[axis] < low_[axis] ? x[axis] - low_[axis] : x[axis] > high_[axis] ? x[axis] - high_[axis] : 0;
      beyond[axis] = d * d;
      distance2 += beyond[axis];
    }
    search(0, x, distance2, beyond, found);
  }

 private:
  /// The left child is the next node.
  struct Node {
    double low = 0, high = 0;           ///< where the left child ends and the right one begins
    std::uint32_t first = 0, last = 0;  ///< rows of a leaf
    std::uint32_t right = 0;            ///< how many nodes on the right child is; 0: a leaf
    std::uint32_t axis = 0;
  };
  struct Box {
    Vec3 low, high;
  };

  template <class Found>
  void search(std::uint32_t number, const Vec3& x, double distance2, Vec3& beyond, Found& found) const {
    const Node& node = nodes_[number];
    if (node.right == 0) {
      const double bound = found.bound();
      for (std::uint32_t row = node.first; row < node.last; ++row) {
        double d2 = 0, d = x[0] - points_[row][0];
        d2 += d * d;
        d = x[1] - points_[row][1];
        d2 += d * d;
        d = x[2] - points_[row][2];
        d2 += d * d;
        if (d2 < bound) found.add(d2, row);
      }
      return;
    }
    const double at = x[node.axis], to_low = at - node.low, to_high = at - node.high;
    const bool is_left = to_low + to_high < 0;
    const double cut2 = is_left ? to_high * to_high : to_low * to_low, former = beyond[node.axis];
    search(is_left ? number + 1 : number + node.right, x, distance2, beyond, found);
    distance2 = distance2 + cut2 - former;
    if (!(distance2 <= found.bound())) return;
    beyond[node.axis] = cut2;
    search(is_left ? number + node.right : number + 1, x, distance2, beyond, found);
    beyond[node.axis] = former;
  }

  void grow(std::uint32_t first, std::uint32_t last, Box& box, std::vector<Node>& nodes);
  std::uint32_t divide(std::uint32_t first, std::uint32_t last, const Box& box, std::uint32_t& axis, double& cut);
  std::array<std::uint32_t, 2> part(std::uint32_t first, std::uint32_t last, std::uint32_t axis, double cut);

  std::vector<Vec3> points_;
  std::vector<std::uint32_t> numbers_;
  std::vector<Node> nodes_;
  Vec3 low_, high_;
};

}  // namespace umtet::detail
