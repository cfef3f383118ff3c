#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "common/context.h"
#include "common/vec3.h"

namespace umtet {

/// Where a mesh has to be fine: edge length h up to `radius` from x, more beyond. Model units.
struct SizeSource {
  Vec3 x;
  double h;
  double radius = 0;
};

/// A bounding volume tree of size sources, for the least over i of h_i + grade max(0, |x - x_i| - radius_i).
///
/// With a_i = h_i - grade radius_i that is max(h_i, a_i + grade |x - x_i|), so a node with the least h_i, the least a_i
/// and the box of its sources bounds them all. Halves at the median of the longer axis of the box: the same for any
/// number of threads. Queries are thread-safe and do not allocate.
class SourceTree {
 public:
  SourceTree() = default;
  /// \pre grade > 0; finite numbers. Cost: O(n log n), threads over halves
  SourceTree(std::vector<SizeSource> sources, double grade);

  /// In the order of the leaves.
  const std::vector<SizeSource>& sources() const { return sources_; }
  /// The least of the sources at x, and `most`: never above it, and at most 5 % below.
  /// @param least  that all of them have
  double at(const Vec3& x, double least, double most) const;
  /// The same of the least in a cube.
  double least_in(const Vec3& centre, double half_width, double least, double most) const;
  /// Whether another source asks for no more than this one, wherever x is: h_i <= h_k and a_i + grade |x_i - x_k| <=
  /// a_k. Of two that are the same the first one stays.
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
  std::vector<Node> nodes_;  ///< of a complete binary tree; the children of k are 2 k + 1 and 2 k + 2
  std::size_t first_leaf_ = 0;
};

/// The sources without those that others make superfluous (SourceTree::is_dominated). Cost: O(n log n), threads over
/// sources. \throw Cancelled
std::vector<SizeSource> undominated(std::vector<SizeSource> sources, double grade, const Context& context = {});

/// The sources without those that another within tolerance * h of them asks for nearly as little: the least of all
/// becomes larger by no more than `tolerance` of itself. Cost: O(n log n)
std::vector<SizeSource> thinned(std::vector<SizeSource> sources, double grade, double tolerance);

}  // namespace umtet
