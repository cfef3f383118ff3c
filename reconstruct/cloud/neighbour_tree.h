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

/// A point of the cloud and its squared distance from the place of the query.
struct Neighbour {
  double distance2;
  std::uint32_t point;
};

/// Between two points, as the searches of NeighbourTree have it, to the bit.
double squared_distance(const Vec3& a, const Vec3& b);

/// Nearest neighbours, balls and rays of a cloud, exactly, in double: FLANN's k-d tree (KDTreeSingleIndex).
///
/// Its searches run with our result sets: its own take radii in single precision and leave the choice between equal
/// distances to the shape of the tree. Here that is the order of point numbers. Nothing depends on the number of
/// threads. Places of queries are finite and at most kLargestCoordinate, like the points. Searches may run at
/// once.
class NeighbourTree {
 public:
  /// Squared distances stay finite up to here.
  static constexpr double kLargestCoordinate = 1e153;

  /// \throw std::invalid_argument  no points, 2^31 or more, or a coordinate not finite or beyond kLargestCoordinate
  explicit NeighbourTree(const std::vector<Vec3>& points);
  ~NeighbourTree();
  NeighbourTree(NeighbourTree&&) noexcept;
  NeighbourTree& operator=(NeighbourTree&&) noexcept;

  std::size_t size() const { return order_.size(); }

  /// All points, along Morton's curve: every m-th of them are spread evenly over the cloud.
  const std::vector<std::uint32_t>& order() const { return order_; }

  /// The nearest to x, nearest first: as many as there is room for, or all points. Equal distances come in the order
  /// of point numbers. @return the part of `room` that is filled
  std::span<const Neighbour> k_nearest(const Vec3& x, std::span<Neighbour> room) const;

  /// Calls visit(i, the k nearest of point i, itself among them) for every point, from several threads at once: visit
  /// may write to what belongs to i and to nothing else. It goes along the curve, so that a search finds in the cache
  /// what the former one has used. \throw std::invalid_argument  k = 0
  void for_each_neighbourhood(std::size_t k,
                              const std::function<void(std::uint32_t, std::span<const Neighbour>)>& visit) const;

  /// Calls visit(point, distance2) for all points with distance2 <= radius2 from x, in no order that means anything.
  template <class Visit>
  void within(const Vec3& x, double radius2, Visit&& visit) const {
    visit_ball(x, radius2, std::ref(visit));  // a std::function of a reference: nothing is allocated for captures
  }

  /// How many points lie within a distance, or `limit` as soon as there are that many.
  std::size_t count_within(const Vec3& x, double radius2, std::size_t limit) const;

  /// The first point along the ray x + t d, t >= t_min, that is within `width` of the ray and accepted.
  struct Hit {
    double t = std::numeric_limits<double>::infinity();
    std::uint32_t point = std::numeric_limits<std::uint32_t>::max();
  };
  /// @param d  unit, or zero: no hit.  @param width  > 0.  \throw std::invalid_argument  width not > 0
  Hit first_along(const Vec3& x, const Vec3& d, double t_min, double width,
                  const std::function<bool(std::uint32_t)>& accept) const;

 private:
  void visit_ball(const Vec3& x, double radius2, const std::function<void(std::uint32_t, double)>& visit) const;

  struct Index;  // these keep FLANN out of this header
  class TubePiece;
  std::vector<std::uint32_t> order_;
  std::unique_ptr<Index> index_;
};

}  // namespace umtet
