#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// A point of the cloud and its squared distance from the query position.
struct Neighbour {
  double distance2;
  std::uint32_t point;
};

/// Squared distance between two points, equal to the bit to the one in the searches of NeighbourTree.
double squared_distance(const Vec3& a, const Vec3& b);

/// k-d tree of a cloud for exact searches, in double, of nearest neighbours, balls and rays. It uses FLANN
/// (KDTreeSingleIndex).
///
/// Its searches run with our result sets: those of FLANN take radii in single precision and let the shape of the tree
/// decide between equal distances. Here the order of point numbers decides. Nothing depends on the number of threads.
/// Query positions are finite and at most kLargestCoordinate, like the points. Searches are thread-safe.
class NeighbourTree {
 public:
  /// Squared distances are finite up to this coordinate.
  static constexpr double kLargestCoordinate = 1e153;

  /// \throw std::invalid_argument for no points, 2^31 or more points, or a coordinate that is not finite or beyond
  ///        kLargestCoordinate
  explicit NeighbourTree(const std::vector<Vec3>& points);
  ~NeighbourTree();
  NeighbourTree(NeighbourTree&&) noexcept;
  NeighbourTree& operator=(NeighbourTree&&) noexcept;

  std::size_t size() const { return order_.size(); }

  /// All points along Morton's curve: every m-th of them are spread evenly over the cloud.
  const std::vector<std::uint32_t>& order() const { return order_; }

  /// The nearest points to x, nearest first: as many as fit into `room`, or all points. Points at equal distances are
  /// in the order of point numbers. @return the part of `room` that is filled
  std::span<const Neighbour> k_nearest(const Vec3& x, std::span<Neighbour> room) const;

  /// Calls visit(i, the k nearest of point i, itself included) for every point, from several threads at once: visit may
  /// write only to data of i. Points are visited along the curve, so that a search finds in the cache what the previous
  /// one used. \throw std::invalid_argument for k = 0
  void for_each_neighbourhood(std::size_t k,
                              const std::function<void(std::uint32_t, std::span<const Neighbour>)>& visit) const;

  /// Calls visit(point, distance2) for all points with distance2 <= radius2 from x, in unspecified order.
  template <class Visit>
  void within(const Vec3& x, double radius2, Visit&& visit) const {
    visit_ball(x, radius2, std::ref(visit));  // a std::function of a reference does not allocate memory for captures
  }

  /// The number of points within a distance, or `limit` as soon as there are that many.
  std::size_t count_within(const Vec3& x, double radius2, std::size_t limit) const;

  /// The first accepted point along the ray x + t d, t >= t_min, that is within `width` of the ray.
  struct Hit {
    double t = std::numeric_limits<double>::infinity();
    std::uint32_t point = std::numeric_limits<std::uint32_t>::max();
  };
  /// @param d  unit, or zero: no hit.  @param width  > 0.  \throw std::invalid_argument if width is not > 0
  Hit first_along(const Vec3& x, const Vec3& d, double t_min, double width,
                  const std::function<bool(std::uint32_t)>& accept) const;

 private:
  void visit_ball(const Vec3& x, double radius2, const std::function<void(std::uint32_t, double)>& visit) const;

  struct Index;  // keeps FLANN out of this header
  class TubePiece;
  std::vector<std::uint32_t> order_;
  std::unique_ptr<Index> index_;
};

}  // namespace umtet
