#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "reconstruct/cloud/neighbours/neighbour_tree.h"
#include "reconstruct/cloud/neighbours/neighbourhoods.h"
#include "reconstruct/cloud/point_cloud.h"

// Merging of samples that are much denser than any detail a mesh can show. Averaging them in the cells of a lattice (a
// voxel grid, also called clustering decimation) keeps their joint information: the position of the surface, its
// normal, the number of samples, and their variance, which is the noise. All later steps then cost as much as there are
// cells.

namespace umtet {

/// The samples grouped by the cubic cells that contain them; cells are ordered along Morton's curve.
class SampleCells {
 public:
  /// Cells are aligned to the middle of the samples, so they move with the cloud. A sample farther than a million cells
  /// from it is a separate cell.
  /// @param edge    edge length of the cells, model units; > 0
  /// @param middle  middle of the samples, core_box()
  /// \throw std::invalid_argument for 2^32 points or more
  /// Cost: a sort; 16 bytes per point.
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
  std::vector<std::size_t> begin_;  ///< begin of each cell in rows_, and the end of the last
  double edge_;
};

/// Robust bounding box: the box of the middle 99 % of each coordinate, unaffected by far outliers, of about 10,000
/// samples picked by their coordinates.
struct CoreBox {
  Vec3 middle = Vec3::Zero();
  double diagonal = 0;  ///< diagonal of the box
};
/// @param points  finite, at least one
CoreBox core_box(const std::vector<Vec3>& points);

/// The largest cells, with an edge of at most `largest`, of which there are about `fewest` or more.
/// @param largest  model units, > 0
SampleCells cells_for(const std::vector<Vec3>& points, const CoreBox& core, double largest, std::size_t fewest);

/// Result of merged_samples().
struct MergedSamples {
  OrientedPointCloud cloud;  ///< with counts and spreads, cells along Morton's curve
  std::size_t n_two_sided =
      0;  ///< cells in which at least a fifth of the samples face the other way: sheets closer than a cell
};

/// Merges the samples of each cell into one sample per label and per side of the normals. A second sheet consists of
/// the samples that face away from the first sample of the cell.
///   count   n, of samples                                       normal  n_bar = sum n_i / |sum n_i|
///   place   x_bar - v n_bar,   x_bar = sum x_i / n,   v = sum n_i . (x_bar - x_i) / 2 n
///   spread  s^2 = sum (n_bar . (x_i - x_bar))^2 / (n - 1)
/// The mean of samples of a curved surface is off the surface by v, to third order in the cell size (ssd_sample.h).
/// Without normals v = 0, and s^2 is the least variance over all directions, with n - 3 degrees of freedom. Origins,
/// colours and fields are means; a field's mean is over the samples where it was measured. Zero normals do not count.
/// @param cells  cells of the cloud's points
/// @param stays  whether the samples of a cell stay unmerged, with a count of one. It is called with the position of
///               one of them, from several threads at once; empty: no cell stays
/// The result depends neither on the order of the samples nor on the number of threads.
MergedSamples merged_samples(const OrientedPointCloud& cloud, const SampleCells& cells,
                             const std::function<bool(const Vec3& x)>& stays = {});

/// Weight of each merged sample relative to those around it: its count divided by the mean count of itself and its
/// neighbours. Density cancels; the remainder is the fraction of a cell that the surface passes through, and the
/// reduced information of a single sample. @param near  neighbourhoods of the samples
std::vector<double> relative_counts(const std::vector<int>& counts, const Neighbourhoods& near);

/// Standard deviation of the samples along the normal before they were merged, by the law of total variance: the
/// variances inside cells, s_j^2 (1 - 1 / n_j), plus those of the means, d_j^2.
///
/// d_j = (n_i + n_j) / 2 . (x_j - x_i), which vanishes to third order on a smooth surface, is taken over the twelve
/// nearest samples with n_i . n_j > .9 of sample i, weighted by counts n_j, minus the square of its mean. The result is
/// the median over evenly picked samples i.
/// @param cloud  merged, with normals; \pre not empty
/// @param tree   tree of the points of the cloud
double noise_before_merging(const OrientedPointCloud& cloud, const NeighbourTree& tree,
                            std::size_t sampled_points = 5000);

}  // namespace umtet
