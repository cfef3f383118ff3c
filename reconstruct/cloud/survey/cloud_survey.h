#pragma once

#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "reconstruct/cloud/cleaning/cleaning.h"
#include "reconstruct/cloud/neighbours/neighbour_tree.h"
#include "reconstruct/cloud/normals/normal_orientation.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Minimum number of points: enough for a quadric and its neighbours, with some to spare.
inline constexpr std::size_t kFewestSurveyed = 30;

/// Error for fewer than kFewestSurveyed points, as given or after cleaning.
struct TooFewPoints : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// Parameters of survey().
struct SurveyParams {
  CleaningParams cleaning;
  OrientationParams orientation;
  double consistent = 0.95;  ///< thickness is measured if given normals are at least this consistent; in [0, 1]
  std::size_t sampled_points = 5000;  ///< number of evenly picked points for noise and thickness; >= 100
};
std::vector<std::string> problems(const SurveyParams&);

/// 1st, 50th and 99th percentile (for thickness 1st, 5th and 50th).
using Percentiles = std::array<double, 3>;

/// Statistics of a cloud. Lengths are in model units. All but the first count describe the cloud without the points in
/// `dropped`.
struct CloudSurvey {
  std::size_t n_points = 0;  ///< number of points of the given cloud
  CleaningReport dropped;    ///< points that cleaning would drop
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  double diagonal = 0;

  Percentiles spacing{};         ///< distance to the nearest neighbour: 1, 50, 99 %
  double density_variation = 1;  ///< ratio of the 99th to the 1st percentile of the sample areas; 2.5 for white noise

  bool has_normals = false;
  bool has_lines_of_sight = false;  ///< true: given in place of normals (lines_of_sight.h), which are then absent
  std::size_t n_normals_zero = 0, n_normals_not_unit = 0;  ///< not unit: to 1e-3
  double consistency = 0;  ///< consistency of the signs of given normals, see normal_orientation.h
  double openness = 0;     ///< |sum a n| / sum a of given normals: 0 for a closed surface
  double volume = 0;       ///< volume enclosed by the given normals; < 0: they point inward

  double noise = 0;  ///< standard deviation along the normal, from local quadrics
  double noise_over_diagonal = 0, noise_over_spacing = 0;

  double farthest_coordinate = 0;
  double ulp_over_spacing = 0;  ///< spacing of doubles at this distance from the origin, relative to the sample spacing
  double float_ulp_over_spacing = 0;  ///< the same for files of single precision: above 0.1 the coordinates have steps

  std::optional<Percentiles>
      thickness;               ///< thickness of the body at a sample: 1, 5, 50 %; if normals are consistent enough
  double thickness_found = 0;  ///< fraction of the samples with an opposite sample
};

/// Surveys a cloud.
/// \throw TooFewPoints for fewer than 30 usable points
/// \throw std::invalid_argument if the numbers of normals and points differ, or for a problem of params
/// Cost: O(n log n), and more with noise. The result does not depend on the number of threads.
CloudSurvey survey(const OrientedPointCloud& cloud, const SurveyParams& params = {});

/// Noise level: standard deviation along the normal, as the median over evenly picked points of the residual of a
/// quadric through the points around. The quadric's ball grows until it is five deviations wide (a narrower one would
/// cut off the noise). For clean clouds the result is the residual of a quadric over 24 neighbours, a hundredth of the
/// spacing and less.
double noise_along_normals(const std::vector<Vec3>& points, std::size_t sampled_points = 5000);
double noise_along_normals(const std::vector<Vec3>& points, const NeighbourTree& tree,
                           std::size_t sampled_points = 5000);

/// Noise level of samples with normals n_i, which distinguish noise from detail as fine as the sample spacing. On a
/// smooth surface 1/2 (n_i + n_j) . (x_j - x_i) vanishes to third order; noise enters it with a factor of sqrt 2. The
/// result is the smaller of both estimates if the one above is less than half the distance to the nearest sample.
/// Beyond that, the nearest samples are those with similar noise, and their differences are not representative.
/// @param cloud  normals unit or zero; without normals: the estimate above
double noise_along_normals(const OrientedPointCloud& cloud, const NeighbourTree& tree,
                           std::size_t sampled_points = 5000);

/// Correlation dimension: D where the number of samples around a sample grows like r^D, at r of 6 to 12 % of the
/// diagonal of their box [GrassbergerProcaccia1983]. It is 2 for a surface with less noise than that, 3 for points that
/// fill a volume, and about 2.8 with the volume's boundary.
double correlation_dimension(const std::vector<Vec3>& points);

/// Cosine of 107 degrees: samples whose normals differ by more are on different sheets. Walls that narrow by less than
/// 73 degrees face each other in this way.
inline constexpr double kOpposed = -.3;

/// Distances from evenly picked samples along their inward normals to the first sample that faces the opposite way.
/// @return ascending, one number per sample for which such a sample was found
std::vector<double> thicknesses(const OrientedPointCloud& cloud, std::size_t sampled_points = 5000);
/// @param tree  of the points
std::vector<double> thicknesses(const OrientedPointCloud& cloud, const NeighbourTree& tree,
                                std::size_t sampled_points = 5000);

/// The samples with another sample within `reach` whose normal differs by more than 107 degrees. They belong to thinner
/// parts and gaps, and to edges of less than 73 degrees.
/// @param tree  tree of the points of the cloud, which must have normals
std::vector<Vec3> near_other_sheets(const OrientedPointCloud& cloud, const NeighbourTree& tree, double reach);

}  // namespace umtet
