#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <vector>

namespace umtet {

/// A sample of the quadratic data term ½ w_value (f(x) − v)² + ½ w_gradient |∇f(x) − n|², all in lattice units.
struct SsdSample {
  Eigen::Vector3d xi;      ///< (x − origin) / h
  Eigen::Vector3d normal;  ///< n_i
  double w_value = 0, w_gradient = 0;
  double value = 0;  ///< v: zero for a sample of the surface, nearly zero for the mean of several
  double gap2 = 0;   ///< area of surface around it in which other samples only repeat it, such as those beside it on a
                     ///< scan line; the least for several
};

/// Samples of the surface as one array per attribute.
struct SampleColumns {
  std::vector<Eigen::Vector3d> places, normals;
  std::vector<double> areas;  ///< relative to h^2: w_gradient
  explicit SampleColumns(const std::vector<SsdSample>& samples);
};

/// Weighted means of the samples in each cube of edge `cube`, sorted by blocks of 8 x 8 x 8 cells.
///
/// The mean position of samples of a curved surface is off the surface. Its value equals, to third order, the value
/// there of the function that the samples describe: f(mean) = sum w (v_i + ½ n_i · (mean − x_i)) / sum w, the trapezoid
/// rule from x_i to the mean, in which the gradient at the mean cancels.
/// @param cube  edge of the cubes in lattice spacings: 1 or ½
std::vector<SsdSample> merge_samples(const std::vector<SsdSample>& samples, double cube);

/// The same for n samples that are computed on demand, by several threads and more than once each.
std::vector<SsdSample> merge_samples(std::size_t n, const std::function<SsdSample(std::size_t)>& sample, double cube);

/// Begin of each run of samples of one block of 8 x 8 x 8 cells, and the number of samples at the end.
std::vector<std::size_t> block_runs(const std::vector<SsdSample>& samples);

/// The cell of a sample, by rounding its coordinates down.
inline Eigen::Vector3i cell_of(const SsdSample& s) { return s.xi.array().floor().cast<int>(); }

/// The sample in units of the lattice of twice the spacing.
SsdSample coarsened(SsdSample sample);

}  // namespace umtet
