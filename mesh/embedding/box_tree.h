#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "mesh/core/tet_mesh.h"

namespace umtet {

/// Bounding volume tree of triangles. Nodes are halved at the median of the longer axis of centroids; the shape is the
/// same for any number of threads. Keeps references to its arguments.
class BoxTree {
 public:
  using Box = Eigen::AlignedBox3d;

  /// \pre indices are in range. Cost: O(n log n), threads over halves
  BoxTree(const std::vector<Vec3>& V, const std::vector<Triangle>& faces);

  /// Triangles are stored in the order of the leaves; a leaf is a range of this order.
  std::size_t n_leaves() const { return leaves_.size(); }
  const std::vector<int>& order() const { return order_; }
  struct Range {
    int begin, end;
  };
  Range leaf(std::size_t k) const { return leaves_[k]; }
  const Box& leaf_box(std::size_t k) const { return boxes_[first_leaf_ + k]; }
  /// The box of the triangle at an index of order().
  const Box& box_at(int place) const { return triangle_boxes_[static_cast<std::size_t>(place)]; }

  /// Calls f(k) for every leaf k >= first whose box the predicate accepts, ascending.
  template <class Accepts, class F>
  void for_leaves(std::size_t first, const Accepts& accepts, const F& f) const {
    std::size_t stack[64];
    int n = 0;
    stack[n++] = 0;
    while (n > 0) {
      const std::size_t node = stack[--n];
      if (last_leaf_below(node) < first || !accepts(boxes_[node])) continue;
      if (node >= first_leaf_) {
        f(node - first_leaf_);
      } else {
        stack[n++] = 2 * node + 2;
        stack[n++] = 2 * node + 1;
      }
    }
  }

 private:
  /// The last leaf below a node of a complete binary tree, whose leaves are numbered from the left.
  std::size_t last_leaf_below(std::size_t node) const {
    while (node < first_leaf_) node = 2 * node + 2;
    return node - first_leaf_;
  }
  void split(std::size_t node, int begin, int end, std::vector<Vec3>& centroid);

  const std::vector<Vec3>& V_;
  const std::vector<Triangle>& faces_;
  std::vector<int> order_;
  std::vector<Box> triangle_boxes_;  ///< in the order of order_
  std::vector<Range> leaves_;
  std::vector<Box> boxes_;  ///< boxes of the nodes; the children of k are 2 k + 1 and 2 k + 2
  std::size_t first_leaf_ = 0;
};

}  // namespace umtet
