#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reconstruct/cloud/neighbours/neighbour_tree.h"

namespace umtet {

/// The k nearest neighbours of every point, nearest first, equal distances by point number. They are searched once and
/// used by cleaning, areas and the sign graph. A point at the same position is a neighbour at distance 0.
///
/// Distances are not stored, because they would be two thirds of the data. They are recomputed, to the bit, from the
/// points that were searched, or from those minus a far_origin_shift().
class Neighbourhoods {
 public:
  /// k in all steps of the preparation: about two rings of neighbours on a surface.
  static constexpr std::size_t kDefault = 12;

  Neighbourhoods() = default;
  /// k is limited to size - 1. \throw std::invalid_argument for k = 0, or as NeighbourTree
  /// Cost: a search of k neighbours, and 4 k bytes, per point.
  Neighbourhoods(const NeighbourTree& tree, std::size_t k);
  explicit Neighbourhoods(const std::vector<Vec3>& points, std::size_t k = kDefault);

  std::size_t size() const { return n_; }
  std::size_t k() const { return k_; }
  std::span<const std::uint32_t> points(std::size_t i) const { return {points_.data() + i * k_, k_}; }
  /// Squared distance from point i to its m-th neighbour. @param x  the points
  double distance2(const std::vector<Vec3>& x, std::size_t i, std::size_t m) const {
    return squared_distance(x[i], x[points_[i * k_ + m]]);
  }
  double last_distance2(const std::vector<Vec3>& x, std::size_t i) const { return distance2(x, i, k_ - 1); }
  /// Sum over all its neighbours, the nearest first.
  double sum_of_distances2(const std::vector<Vec3>& x, std::size_t i) const;
  bool has(std::size_t i, std::uint32_t j) const;

 private:
  std::size_t n_ = 0, k_ = 0;
  std::vector<std::uint32_t> points_;
};

}  // namespace umtet
