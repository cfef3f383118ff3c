#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "reconstruct/cloud/neighbour_tree.h"
#include "reconstruct/cloud/neighbourhoods.h"
#include "reconstruct/cloud/point_cloud.h"

// Samples much denser than anything a mesh can show say the same thing many times. Averaging them in the cells of a
// lattice (a voxel grid, also called clustering decimation) keeps what they say together: where the surface is, its
// normal, how many said it, and by how much they differ, which is their noise. Everything after it costs as much as
// there are cells.

namespace umtet {

/// The samples in the order of the cubic cells that they lie in, cells along Morton's curve.
class SampleCells {
 public:
  /// A cell has a corner in the middle of the samples, so the cells move with the cloud. Samples farther than a million
  /// cells from it are cells of their own.
  /// @param edge  of the cells, model units; > 0
  /// @param middle  of the samples, middle_of()
  /// \throw std::invalid_argument  2^32 points or more
  /// Cost: a sort; 16 bytes a point.
  SampleCells(const std::vector<Vec3>& points, double edge, const Vec3& middle);

  std::size_t size() const { return begin_.size() - 1; }
  double edge() const { return edge_; }
  /// Calls visit(point) for the points of a cell.
  template <class Visit>
  void for_each_point(std::size_t cell, Visit&& visit) const {
    for (std::size_t row = begin_[cell]; row < begin_[cell + 1]; ++row) visit(rows_[row].point);
  }

 private:
  struct Row {
    std::uint64_t code;
    std::uint32_t point;
    bool operator<(const Row& o) const { return code != o.code ? code < o.code : point < o.point; }
  };
  std::vector<Row> rows_;
  std::vector<std::size_t> begin_;  ///< of each cell in rows_, and the end of the last
  double edge_;
};

/// Where most of the samples are, whatever lies far out: the box of the middle 99 % of each coordinate, of some 10,000
/// samples picked by their coordinates.
struct CoreBox {
  Vec3 middle = Vec3::Zero();
  double diagonal = 0;  ///< of the box
};
/// @param points  finite, at least one
CoreBox core_box(const std::vector<Vec3>& points);

/// Cells of the largest edge that leaves about `fewest` of them or more, at most `largest`.
/// @param largest  model units, > 0
SampleCells cells_for(const std::vector<Vec3>& points, const CoreBox& core, double largest, std::size_t fewest);

struct MergedSamples {
  OrientedPointCloud cloud;  ///< with counts and spreads, cells along Morton's curve
  std::size_t n_two_sided =
      0;  ///< cells of which a fifth of the samples or more look the other way: sheets closer than a cell
};

/// One sample a cell, for each label in it and each of the two sides that normals look to, a second sheet being one
/// that looks away from the first sample of the cell:
///   count   n, of samples                                       normal  n_bar = sum n_i / |sum n_i|
///   place   x_bar - v n_bar,   x_bar = sum x_i / n,   v = sum n_i . (x_bar - x_i) / 2 n
///   spread  s^2 = sum (n_bar . (x_i - x_bar))^2 / (n - 1)
/// The mean of samples of a curved surface lies beside it, by v to third order in the cell (ssd_sample.h). Without
/// normals v = 0, and s^2 is the least variance over all directions, of n - 3 degrees of freedom. Origins, colours and
/// fields are means; of a field that of the samples where it was measured. Normals that are zero do not count.
/// @param cells  of its points
/// @param stays  whether the samples of a cell stay what they are, with a count of one: called with the place of one of
///               them, from several threads at once; empty: nowhere
/// Does not depend on the order of the samples, nor on the number of threads.
MergedSamples merged_samples(const OrientedPointCloud& cloud, const SampleCells& cells,
                             const std::function<bool(const Vec3& x)>& stays = {});

/// How much each merged sample weighs against those around it: its count over the mean count of itself and its
/// neighbours. Density cancels; what is left is the share of a cell that the surface passes through, and how much less
/// is known by a single sample. @param near  of the samples
std::vector<double> relative_counts(const std::vector<int>& counts, const Neighbourhoods& near);

/// Standard deviation of the samples along the normal before they were merged: what they differ by in their cells and
/// what their means differ by, s_j^2 (1 - 1 / n_j) and d_j^2, by the law of total variance. d_j = (n_i + n_j) / 2 .
/// (x_j - x_i), which vanishes to third order on a smooth surface, over the twelve nearest with n_i . n_j > .9 of
/// sample i, weighted by counts n_j, less the square of its mean; then the median over evenly picked samples i.
/// @param cloud  merged, with normals; \pre not empty
/// @param tree  of its points
double noise_before_merging(const OrientedPointCloud& cloud, const NeighbourTree& tree,
                            std::size_t sampled_points = 5000);

}  // namespace umtet
