#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <vector>

namespace umtet {

/// One sample of the quadratic data term ½ w_value (f(x) − v)² + ½ w_gradient |∇f(x) − n|², all in lattice units.
struct SsdSample {
  Eigen::Vector3d xi;      ///< (x − origin) / h
  Eigen::Vector3d normal;  ///< n_i
  double w_value = 0, w_gradient = 0;
  double value = 0;  ///< v: zero for a sample of the surface, not quite for the mean of several
  double gap2 = 0;   ///< area of surface around it in which others only repeat it, such as those beside it on a scan
                     ///< line; the least of several
};

/// Samples of the surface, a column each.
struct SampleColumns {
  std::vector<Eigen::Vector3d> places, normals;
  std::vector<double> areas;  ///< over h^2: w_gradient
  explicit SampleColumns(const std::vector<SsdSample>& samples);
};

/// Weighted means of the samples that share a cube of edge `cube`, sorted by the blocks of 8 x 8 x 8 cells they lie in.
///
/// The mean position of samples of a curved surface lies beside it. Its value is that of the functions that the samples
/// describe, to third order: f(mean) = sum w (v_i + ½ n_i · (mean − x_i)) / sum w, the trapezoid rule from x_i to the
/// mean, where the mean's own gradient drops out.
/// @param cube  in lattice spacings: 1 or ½
std::vector<SsdSample> merge_samples(const std::vector<SsdSample>& samples, double cube);

/// The same of n samples that are made when they are asked for, by several threads and more than once each.
std::vector<SsdSample> merge_samples(std::size_t n, const std::function<SsdSample(std::size_t)>& sample, double cube);

/// Where each run of samples of one block of 8 x 8 x 8 cells begins, and how many samples there are.
/// @param samples  in block order
std::vector<std::size_t> block_runs(const std::vector<SsdSample>& samples);

/// The cell, of which a sample's coordinates are the lower ones and more.
inline Eigen::Vector3i cell_of(const SsdSample& s) { return s.xi.array().floor().cast<int>(); }

/// The sample as one of the lattice of twice the spacing, for coefficients in units of that spacing.
SsdSample coarsened(SsdSample sample);

}  // namespace umtet
