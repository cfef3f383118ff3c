#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "common/context.h"
#include "common/vec3.h"

namespace umtet {

/// Size source: edge length h is required within `radius` of x, and larger lengths beyond. Model units.
struct SizeSource {
  Vec3 x;
  double h;
  double radius = 0;
};

/// Bounding volume tree of size sources, which computes the minimum over i of h_i + grade max(0, |x - x_i| - radius_i).
///
/// With a_i = h_i - grade radius_i this is max(h_i, a_i + grade |x - x_i|), so the least h_i, the least a_i and the box
/// of a node's sources give a bound for all of them. Nodes are halved at the median of the longer axis of the box. The
/// tree is the same for any number of threads. Queries are thread-safe and do not allocate.
class SourceTree {
 public:
  SourceTree() = default;
  /// \pre grade > 0; finite numbers. Cost: O(n log n), threads over halves
  SourceTree(std::vector<SizeSource> sources, double grade);

  /// The sources in the order of the leaves.
  const std::vector<SizeSource>& sources() const { return sources_; }
  /// Minimum of `most` and the sources at x: never above the exact value, and at most 5 % below.
  /// @param least  lower bound of all sources
  double at(const Vec3& x, double least, double most) const;
  /// The same for the minimum over a cube.
  double least_in(const Vec3& centre, double half_width, double least, double most) const;
  /// True if another source requires no more than source k for any x: h_i <= h_k and a_i + grade |x_i - x_k| <= a_k. Of
  /// two equal sources the first is kept.
  bool is_dominated(std::size_t k) const;

 private:
  using Box = Eigen::AlignedBox3d;
  struct Node {
    Box box;
    double h, a;  ///< the least of the sources below
  };
  struct Range {
    std::size_t begin, end;
  };
  double a_of(const SizeSource& s) const { return s.h - grade_ * s.radius; }
  double bound(const Node& node, double distance) const;
  void split(std::size_t node, std::size_t begin, std::size_t end);
  template <class NodeBound, class SourceValue>
  double least(const NodeBound& of_node, const SourceValue& of_source, double least, double most) const;

  double grade_ = 1;
  std::vector<SizeSource> sources_;
  std::vector<Range> leaves_;
  std::vector<Node> nodes_;  ///< a complete binary tree; the children of k are 2 k + 1 and 2 k + 2
  std::size_t first_leaf_ = 0;
};

/// The sources that no other source dominates (SourceTree::is_dominated). Cost: O(n log n). Uses threads over sources.
/// \throw Cancelled
std::vector<SizeSource> undominated(std::vector<SizeSource> sources, double grade, const Context& context = {});

/// The sources without those that another source within tolerance * h makes nearly redundant. The minimum of all
/// increases by at most the fraction `tolerance`. Cost: O(n log n)
std::vector<SizeSource> thinned(std::vector<SizeSource> sources, double grade, double tolerance);

}  // namespace umtet
