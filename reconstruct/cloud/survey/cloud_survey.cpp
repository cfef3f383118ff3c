#include "reconstruct/cloud/survey/cloud_survey.h"

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "common/formatted.h"
#include "reconstruct/cloud/cloud_arrays.h"
#include "reconstruct/cloud/neighbours/cloud_neighbours.h"
#include "reconstruct/cloud/neighbours/local_quadric.h"
#include "reconstruct/cloud/neighbours/neighbour_tree.h"
#include "reconstruct/cloud/normals/enclosed_volume.h"
#include "reconstruct/cloud/normals/lines_of_sight.h"

namespace umtet {
namespace {

constexpr std::size_t kNoiseNeighbours = 24;  // four times the 6 coefficients of a quadric

double percentile(std::vector<double>& values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Every m-th point along the tree's curve: evenly over the surface, and no seed to remember.
/// @param counts  of merged samples; else empty
std::vector<std::uint32_t> evenly_picked(const NeighbourTree& tree, std::size_t n_picked,
                                         const std::vector<int>& counts = {}) {
  const auto count = [&](std::size_t row) { return count_of(counts, tree.order()[row]); };
  const std::size_t n = sum_of_counts(counts, tree.size());
  std::vector<std::uint32_t> picked;
  for (const std::size_t row : every_mth(std::max<std::size_t>(1, n / n_picked), tree.size(), count))
    picked.push_back(tree.order()[row]);
  return picked;
}

/// Root of the area that a sample at x stands for, as sample_areas has it.
double spacing_around(const NeighbourTree& tree, const Vec3& x) {
  std::array<Neighbour, kAreaNeighbours + 1> room;
  const std::span<const Neighbour> near = tree.k_nearest(x, room);
  double sum = 0;
  for (const Neighbour& other : near) sum += other.distance2;
  const auto k = static_cast<double>(near.size() - 1);
  return k > 0 ? std::sqrt(2 * std::numbers::pi * sum / (k * (k + 2))) : 0;
}

/// Residual variance around a point. `near` is a buffer.
double local_variance(const std::vector<Vec3>& points, const NeighbourTree& tree, const Vec3& x,
                      std::vector<Neighbour>& near) {
  // The radius grows by sqrt 2 up to five times, to 5.7 times that of 24 neighbours.
  constexpr double kGrowth = std::numbers::sqrt2, kDeviations = 5;
  constexpr int kRadii = 6;
  near.resize(kNoiseNeighbours);
  const double radius = std::sqrt(tree.k_nearest(x, near).back().distance2);
  double variance = -1, growth = 1;
  for (int k = 0; k < kRadii; ++k, growth *= kGrowth) {
    near.clear();
    const double r = growth * radius;
    tree.within(x, r * r, [&](std::uint32_t j, double distance2) { near.push_back({distance2, j}); });
    const double wider = local_quadric(points, x, near).variance;
    // Noise has the same variance in every ball. Three times as much in twice the area is another sheet, or a bend.
    if (variance > 0 && wider > 3 * variance) break;
    variance = wider;
    if (r * r >= kDeviations * kDeviations * variance) break;
  }
  return variance;
}

}  // namespace

double noise_along_normals(const std::vector<Vec3>& points, std::size_t sampled_points) {
  return noise_along_normals(points, NeighbourTree(points), sampled_points);
}

double noise_along_normals(const std::vector<Vec3>& points, const NeighbourTree& tree, std::size_t sampled_points) {
  if (points.size() < kFewestSurveyed)
    throw TooFewPoints(formatted("%zu points: noise needs at least %zu", points.size(), kFewestSurveyed));
  const std::vector<std::uint32_t> picked = evenly_picked(tree, sampled_points);
  std::vector<double> variance(picked.size());
  tbb::enumerable_thread_specific<std::vector<Neighbour>> buffers;
  tbb::parallel_for(std::size_t{0}, picked.size(), [&](std::size_t p) {
    variance[p] = local_variance(points, tree, points[picked[p]], buffers.local());
  });
  return std::sqrt(std::max(0.0, percentile(variance, 0.5)));
}

double noise_along_normals(const OrientedPointCloud& cloud, const NeighbourTree& tree, std::size_t sampled_points) {
  constexpr std::size_t kPairs = 8;       // of each sample and its nearest ones, which are up to two spacings away
  constexpr double kMostOfDistance = .5;  // noise above this share of the sample spacing comes from quadrics alone
  constexpr double kDeviationsOfMedian = 1.4826;  // 1 / quantile(3/4) of the normal distribution
  const double of_quadrics = noise_along_normals(cloud.points, tree, sampled_points);
  if (cloud.normals.empty()) return of_quadrics;
  const std::vector<std::uint32_t> picked = evenly_picked(tree, sampled_points);
  std::vector<double> defect(kPairs * picked.size()), nearest(picked.size());
  tbb::parallel_for(std::size_t{0}, picked.size(), [&](std::size_t p) {
    const std::uint32_t i = picked[p];
    std::array<Neighbour, kPairs + 1> room;
    std::size_t k = kPairs * p;
    for (const Neighbour& other : tree.k_nearest(cloud.points[i], room)) {
      if (other.point == i || k == kPairs * (p + 1)) continue;
      if (k == kPairs * p) nearest[p] = std::sqrt(other.distance2);
      const std::uint32_t j = other.point;
      defect[k++] = std::abs((cloud.normals[i] + cloud.normals[j]).dot(cloud.points[j] - cloud.points[i])) / 2;
    }
  });
  if (of_quadrics > kMostOfDistance * percentile(nearest, .5)) return of_quadrics;
  return std::min(of_quadrics, kDeviationsOfMedian / std::numbers::sqrt2 * percentile(defect, .5));
}

double correlation_dimension(const std::vector<Vec3>& points) {
  constexpr double kRadius = .06;        // over the diagonal
  constexpr std::size_t kCentres = 300;  // enough for D to .05
  const NeighbourTree tree(points);
  Eigen::AlignedBox3d box;
  for (const Vec3& x : points) box.extend(x);
  const double r2 = std::pow(kRadius, 2) * box.diagonal().squaredNorm();
  const std::vector<std::uint32_t> picked = evenly_picked(tree, kCentres);
  std::vector<std::size_t> inner(picked.size()), outer(picked.size());
  tbb::parallel_for(std::size_t{0}, picked.size(), [&](std::size_t p) {
    inner[p] = tree.count_within(points[picked[p]], r2, points.size());
    outer[p] = tree.count_within(points[picked[p]], 4 * r2, points.size());
  });
  const auto sum = [](const std::vector<std::size_t>& n) {
    return static_cast<double>(std::accumulate(n.begin(), n.end(), std::size_t{0}));
  };
  return std::log2(sum(outer) / sum(inner));
}

std::vector<double> thicknesses(const OrientedPointCloud& cloud, std::size_t sampled_points) {
  return thicknesses(cloud, NeighbourTree(cloud.points), sampled_points);
}

std::vector<double> thicknesses(const OrientedPointCloud& cloud, const NeighbourTree& tree,
                                std::size_t sampled_points) {
  // Of the tube around a ray: a narrower one slips between the samples of the other side, a wider one meets samples
  // beside the ray.
  constexpr double kWidthOverSpacing = 1.5;
  const std::vector<std::uint32_t> picked = evenly_picked(tree, sampled_points, cloud.counts);
  std::vector<double> met(picked.size());
  tbb::parallel_for(std::size_t{0}, picked.size(), [&](std::size_t p) {
    const std::uint32_t i = picked[p];
    const Vec3& n = cloud.normals[i];
    const double spacing = spacing_around(tree, cloud.points[i]);
    if (!(spacing > 0)) {  // all neighbours are at the same place
      met[p] = std::numeric_limits<double>::infinity();
      return;
    }
    met[p] = tree.first_along(cloud.points[i], -n, 0, kWidthOverSpacing * spacing,
                              [&](std::uint32_t j) { return cloud.normals[j].dot(n) < kOpposed; })
                 .t;
  });
  std::erase_if(met, [](double t) { return !std::isfinite(t); });
  std::sort(met.begin(), met.end());
  return met;
}

std::vector<Vec3> near_other_sheets(const OrientedPointCloud& cloud, const NeighbourTree& tree, double reach) {
  std::vector<std::uint8_t> is_near(cloud.points.size());
  tbb::parallel_for(std::size_t{0}, is_near.size(), [&](std::size_t row) {
    const std::uint32_t i = tree.order()[row];
    tree.within(cloud.points[i], reach * reach, [&](std::uint32_t j, double) {
      if (cloud.normals[i].dot(cloud.normals[j]) < kOpposed) is_near[i] = 1;
    });
  });
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < is_near.size(); ++i)
    if (is_near[i] != 0) places.push_back(cloud.points[i]);
  return places;
}

std::vector<std::string> problems(const SurveyParams& params) {
  std::vector<std::string> found = problems(params.cleaning);
  for (std::string& more : problems(params.orientation)) found.push_back(std::move(more));
  if (!(params.consistent >= 0 && params.consistent <= 1))
    found.push_back(formatted("consistent = %g: must be in 0..1", params.consistent));
  if (params.sampled_points < 100)
    found.push_back(formatted("sampled_points = %zu: must be >= 100", params.sampled_points));
  return found;
}

CloudSurvey survey(const OrientedPointCloud& original, const SurveyParams& params) {
  if (const auto found = problems(params); !found.empty()) throw std::invalid_argument(found.front());
  CloudSurvey result;
  result.n_points = original.points.size();
  OrientedPointCloud cloud = original;
  Neighbourhoods around;
  Covering covering;
  result.dropped = clean(cloud, params.cleaning, &around, &covering);
  const std::size_t n = cloud.points.size();
  if (n < kFewestSurveyed)
    throw TooFewPoints(formatted("%zu usable points: a survey needs at least %zu", n, kFewestSurveyed));

  result.low = result.high = cloud.points.front();
  for (const Vec3& x : cloud.points) {
    result.low = result.low.cwiseMin(x);
    result.high = result.high.cwiseMax(x);
  }
  result.diagonal = (result.high - result.low).norm();
  NeighbourDistances near = neighbour_distances(cloud.points, kAreaNeighbours);
  std::vector<double> areas = sample_areas(near);
  result.spacing = {percentile(near.nearest, 0.01), percentile(near.nearest, 0.5), percentile(near.nearest, 0.99)};
  const double spacing = result.spacing[1];

  const NeighbourTree tree(cloud.points);
  result.farthest_coordinate = result.low.cwiseAbs().cwiseMax(result.high.cwiseAbs()).maxCoeff();
  result.ulp_over_spacing = std::numeric_limits<double>::epsilon() * result.farthest_coordinate / spacing;
  result.float_ulp_over_spacing = std::numeric_limits<float>::epsilon() * result.farthest_coordinate / spacing;

  result.has_normals = !cloud.normals.empty();
  if (result.has_normals) {
    for (Vec3& normal : cloud.normals) {
      if (!normal.allFinite() || normal.isZero(0)) {
        ++result.n_normals_zero;
        normal.setZero();
      } else if (const double length = normal.stableNorm(); std::abs(length - 1) > 1e-3) {
        ++result.n_normals_not_unit;
        normal.stableNormalize();
      }
    }
    result.has_lines_of_sight = are_lines_of_sight(cloud, around, covering);
    result.has_normals = !result.has_lines_of_sight;
    if (!result.has_normals) cloud.normals.clear();
  }
  if (result.has_normals) {
    result.consistency = consistency(cloud, params.orientation);
    const EnclosedVolume body = enclosed_volumes(cloud, areas, std::vector<std::uint32_t>(n, 0), 1).front();
    result.volume = body.volume;
    result.openness = body.openness;
    if (result.consistency >= params.consistent) {
      const std::vector<double> met = thicknesses(cloud, tree, params.sampled_points);
      const std::size_t stride = std::max<std::size_t>(1, n / params.sampled_points),
                        n_picked = (n + stride - 1) / stride;
      result.thickness_found = static_cast<double>(met.size()) / static_cast<double>(n_picked);
      const auto at = [&](double share) {
        return met[static_cast<std::size_t>(share * static_cast<double>(met.size() - 1))];
      };
      if (!met.empty()) result.thickness = Percentiles{at(0.01), at(0.05), at(0.5)};
    }
  }
  result.noise = noise_along_normals(cloud, tree, params.sampled_points);
  result.noise_over_diagonal = result.noise / result.diagonal;
  result.noise_over_spacing = result.noise / spacing;
  const double largest = percentile(areas, 0.99), least = percentile(areas, 0.01);
  result.density_variation = least > 0 ? largest / least : 1;
  return result;
}

}  // namespace umtet
