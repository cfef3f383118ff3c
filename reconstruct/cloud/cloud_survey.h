#pragma once

#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "reconstruct/cloud/cleaning.h"
#include "reconstruct/cloud/neighbour_tree.h"
#include "reconstruct/cloud/normal_orientation.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// A quadric, its neighbours, and some of them to spare.
inline constexpr std::size_t kFewestSurveyed = 30;

/// Fewer than kFewestSurveyed points, as they came or after cleaning.
struct TooFewPoints : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

struct SurveyParams {
  CleaningParams cleaning;
  OrientationParams orientation;
  double consistent = 0.95;  ///< thickness is measured where given normals are at least this consistent; in [0, 1]
  std::size_t sampled_points = 5000;  ///< noise and thickness are those of so many points, evenly picked; >= 100
};
std::vector<std::string> problems(const SurveyParams&);

/// 1st, 50th and 99th percentile (for thickness 1st, 5th and 50th).
using Percentiles = std::array<double, 3>;

/// What a cloud is like. Lengths in model units. All but the first counts are of the cloud without what `dropped`
/// names.
struct CloudSurvey {
  std::size_t n_points = 0;  ///< as they came
  CleaningReport dropped;    ///< what cleaning would take away
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  double diagonal = 0;

  Percentiles spacing{};  ///< to the nearest neighbour: 1, 50, 99 %
  double density_variation =
      1;  ///< ratio of the 99th to the 1st percentile of area behind a sample; 2.5 for white noise

  bool has_normals = false;
  bool has_lines_of_sight = false;  ///< in the place of normals, see lines_of_sight.h; then it has none
  std::size_t n_normals_zero = 0, n_normals_not_unit = 0;  ///< not unit: to 1e-3
  double consistency = 0;                                  ///< of the signs of given normals, see normal_orientation.h
  double openness = 0;                                     ///< |sum a n| / sum a of given normals: 0 closed
  double volume = 0;                                       ///< enclosed by the given normals; < 0: they point inward

  double noise = 0;  ///< standard deviation along the normal, from local quadrics
  double noise_over_diagonal = 0, noise_over_spacing = 0;

  double farthest_coordinate = 0;
  double ulp_over_spacing = 0;        ///< what double leaves of the spacing that far from the origin
  double float_ulp_over_spacing = 0;  ///< the same for files of single precision: above 0.1 they hold steps

  std::optional<Percentiles>
      thickness;               ///< of the body behind a sample: 1, 5, 50 %; where normals are consistent enough
  double thickness_found = 0;  ///< share of the samples with an opposite one
};

/// \throw TooFewPoints           fewer than 30 usable points
/// \throw std::invalid_argument  normals, but not as many as points; a problem of params
/// Cost: O(n log n), and more with noise. The result does not depend on the number of threads.
CloudSurvey survey(const OrientedPointCloud& cloud, const SurveyParams& params = {});

/// Noise along the normal: median over evenly picked points of the residual of a quadric through the points around, in
/// a ball that grows until it is five deviations wide (a narrower one cuts the noise off that it is to measure).
/// Clean clouds read what is left of a quadric over 24 neighbours, a hundredth of the spacing and less.
double noise_along_normals(const std::vector<Vec3>& points, std::size_t sampled_points = 5000);
double noise_along_normals(const std::vector<Vec3>& points, const NeighbourTree& tree,
                           std::size_t sampled_points = 5000);

/// The same of samples with normals n_i, which tell noise from detail as fine as the samples are apart: on a smooth
/// surface 1/2 (n_i + n_j) . (x_j - x_i) vanishes to third order, noise is in it sqrt 2 times. The lesser of the two,
/// as long as that above is less than half the distance to the nearest sample: beyond, the nearest samples are those
/// whose noise happens to be alike, and their differences say too little.
/// @param cloud  normals unit or zero, or none: as above
double noise_along_normals(const OrientedPointCloud& cloud, const NeighbourTree& tree,
                           std::size_t sampled_points = 5000);

/// D where the number of samples around a sample grows like r^D, at r of 6 to 12 % of the diagonal of their box
/// [GrassbergerProcaccia1983]: 2 of a surface whatever its noise, if that is less; 3 of points that fill a volume, some
/// 2.8 with its boundary.
double correlation_dimension(const std::vector<Vec3>& points);

/// Cosine of 107 degrees: a sample whose normal turns that far from another's is of another sheet. Walls that narrow by
/// less than 73 degrees face each other so.
inline constexpr double kOpposed = -.3;

/// Distances from evenly picked samples along their inward normals to the first sample that faces the other way.
/// @return ascending, one number for each sample that met one
/// @param tree  of the points
std::vector<double> thicknesses(const OrientedPointCloud& cloud, std::size_t sampled_points = 5000);
std::vector<double> thicknesses(const OrientedPointCloud& cloud, const NeighbourTree& tree,
                                std::size_t sampled_points = 5000);

/// The samples that have another within `reach` whose normal is more than 107 degrees from theirs: of parts and gaps
/// that are thinner, and of edges of less than 73 degrees. @param tree  of the points of the cloud, which has normals
std::vector<Vec3> near_other_sheets(const OrientedPointCloud& cloud, const NeighbourTree& tree, double reach);

}  // namespace umtet
