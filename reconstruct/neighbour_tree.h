#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "reconstruct/point_cloud.h"

namespace umtet {

/// A point of the cloud and its squared distance from where one asked.
struct Neighbour {
  double distance2;
  std::uint32_t point;
};

/// What a thread keeps between leaves: the neighbours found last and the lists to find them.
class Neighbourhoods {
 public:
  /// The points of the leaf that was asked for, and the neighbours of the q-th of them, nearest first, itself among
  /// them. Equal distances come in the order of point numbers.
  std::span<const std::uint32_t> points() const { return points_; }
  std::span<const Neighbour> of(std::size_t q) const { return {found_.data() + q * k_, k_}; }

 private:
  friend class NeighbourTree;
  std::span<const std::uint32_t> points_;
  std::size_t k_ = 0;
  std::vector<Neighbour> found_;
  struct Leaf {
    std::size_t node, leaf;
  };
  std::vector<Leaf> leaves_;       // that are near enough to matter to a point of the leaf
  std::vector<double> distance2_;  // of the candidates to the point whose turn it is
  std::vector<std::uint32_t> candidates_;

  /// One leaf more than can be kept: candidates are written before it is known that they are kept.
  void reserve(std::size_t n) {
    if (distance2_.size() >= n + 16) return;
    distance2_.resize(n + 16);
    candidates_.resize(n + 16);
  }
};

/// All nearest neighbours of a cloud, exactly, in double.
///
/// A k-d tree with equal leaves over points that lie in memory as in the tree. Neighbours are asked for by leaf: the
/// tree is walked once for all points of a leaf. So all neighbours (k = 13) of 1 M points of a torus take 0.9 s of one
/// core with the build, where FLANN and nanoflann take 1.2 s, both with the points sorted for them.
///
/// Everything is finite and nothing depends on the number of threads. Keeps 60 bytes a point.
class NeighbourTree {
 public:
  static constexpr std::size_t kLeafPoints = 16;

  /// \throw std::invalid_argument  no points, more than 2^32 - 2, or a coordinate not finite
  explicit NeighbourTree(const std::vector<Vec3>& points);

  std::size_t size() const { return ids_.size(); }
  std::size_t n_leaves() const { return n_leaves_; }
  std::span<const std::uint32_t> points_of(std::size_t leaf) const {
    return {ids_.data() + leaf * kLeafPoints, leaf_end(leaf) - leaf * kLeafPoints};
  }

  /// The k nearest of every point of a leaf; all points where there are fewer than k.
  void k_nearest(std::size_t leaf, std::size_t k, Neighbourhoods& found) const;

  /// Calls visit(point, distance2) for all points with distance2 <= radius2 from x, in no order that means anything.
  template <class Visit>
  void within(const Vec3& x, double radius2, Visit&& visit) const;

  /// How many points lie within a distance, or `limit` as soon as there are that many.
  std::size_t count_within(const Vec3& x, double radius2, std::size_t limit) const;

  /// The first point along the ray x + t d, t >= t_min, that is within `width` of the ray and accepted.
  struct Hit {
    double t = std::numeric_limits<double>::infinity();
    std::uint32_t point = std::numeric_limits<std::uint32_t>::max();
  };
  template <class Accept>
  Hit first_along(const Vec3& x, const Vec3& d, double t_min, double width, Accept&& accept) const;

 private:
  struct Box {
    Eigen::Array3d low, high;
    double distance2(const Vec3& x) const {
      return (low - x.array()).max(x.array() - high).max(0).matrix().squaredNorm();
    }
    double farthest2(const Vec3& x) const { return (x.array() - low).max(high - x.array()).matrix().squaredNorm(); }
    double distance2(const Box& other) const {
      return (low - other.high).max(other.low - high).max(0).matrix().squaredNorm();
    }
    /// Where the ray x + t d enters the box grown by `width`; infinity where it does not.
    double entry(const Vec3& x, const Vec3& inverse_d, double width) const;
  };
  struct Record {
    Vec3 x;
    std::uint32_t id;
  };
  /// A node covers the leaves [first, end). Nodes are numbered in preorder: its left child follows it, the right one
  /// comes after the 2 m - 1 nodes of the m leaves on the left.
  struct Node {
    std::size_t index, first, end;
    bool is_leaf() const { return end - first == 1; }
    Node left() const { return {index + 1, first, middle()}; }
    Node right() const { return {index + 2 * (middle() - first), middle(), end}; }
    std::size_t middle() const { return first + (end - first) / 2; }
  };
  // Halving less than 2^32 leaves ends after 32 steps, and a walk keeps one sibling a step.
  using Stack = std::array<Node, 40>;

  Node root() const { return {0, 0, n_leaves_}; }
  std::size_t leaf_end(std::size_t leaf) const { return std::min((leaf + 1) * kLeafPoints, size()); }
  Vec3 position(std::size_t row) const { return {x_[row], y_[row], z_[row]}; }
  void build(std::vector<Record>& records, Node node);
  std::size_t gather(std::size_t leaf, const Vec3& x, double bound2, double* distance2, std::uint32_t* points) const;

  std::size_t n_leaves_;
  std::vector<double> x_, y_, z_;   // by leaf; the last leaf is filled up with infinities
  std::vector<std::uint32_t> ids_;  // row -> point
  std::vector<Box> boxes_;          // node -> box of its points
};

template <class Visit>
void NeighbourTree::within(const Vec3& x, double radius2, Visit&& visit) const {
  Stack stack;
  std::size_t top = 0;
  stack[top++] = root();
  while (top > 0) {
    const Node node = stack[--top];
    if (boxes_[node.index].distance2(x) > radius2) continue;
    if (!node.is_leaf()) {
      stack[top++] = node.right();
      stack[top++] = node.left();
      continue;
    }
    for (std::size_t row = node.first * kLeafPoints; row < leaf_end(node.first); ++row) {
      const double distance2 = (position(row) - x).squaredNorm();
      if (distance2 <= radius2) visit(ids_[row], distance2);
    }
  }
}

template <class Accept>
NeighbourTree::Hit NeighbourTree::first_along(const Vec3& x, const Vec3& d, double t_min, double width,
                                              Accept&& accept) const {
  const Vec3 inverse_d = d.cwiseInverse();
  Hit hit;
  Stack stack;
  std::size_t top = 0;
  stack[top++] = root();
  while (top > 0) {
    const Node node = stack[--top];
    if (boxes_[node.index].entry(x, inverse_d, width) > hit.t) continue;
    if (!node.is_leaf()) {
      stack[top++] = node.right();
      stack[top++] = node.left();
      // The child where the ray starts goes first, so that the first hit ends most of the walk.
      if (boxes_[stack[top - 1].index].entry(x, inverse_d, width) >
          boxes_[stack[top - 2].index].entry(x, inverse_d, width))
        std::swap(stack[top - 1], stack[top - 2]);
      continue;
    }
    for (std::size_t row = node.first * kLeafPoints; row < leaf_end(node.first); ++row) {
      const Vec3 r = position(row) - x;
      const double t = r.dot(d);
      if (t < t_min || t > hit.t || (r - t * d).squaredNorm() > width * width) continue;
      if ((t < hit.t || ids_[row] < hit.point) && accept(ids_[row])) hit = {t, ids_[row]};
    }
  }
  return hit;
}

/// Calls visit(i, the k nearest of point i, itself among them) for every point, from several threads at once: visit may
/// write to what belongs to i and to nothing else.
/// @param done  points to leave out; empty: none. Leaves of which all points are done cost nothing.
void for_each_neighbourhood(const NeighbourTree& tree, std::size_t k,
                            const std::function<void(std::uint32_t, std::span<const Neighbour>)>& visit,
                            const std::vector<std::uint8_t>& done = {});

}  // namespace umtet
