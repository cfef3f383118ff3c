#include "reconstruct/patches/filtered_normals.h"

#include <oneapi/tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "reconstruct/patches/local_sheet.h"
#include "reconstruct/patches/measures.h"

namespace umtet {
namespace {

constexpr std::size_t kAround = 12;   ///< a neighbourhood: two rings of samples
constexpr double kLeastScale = .26;   ///< radians (15 degrees): curvature of radius 5 spacings within 1.3 spacings
constexpr double kLargestScale = .7;  ///< radians (40 degrees): less than half a right angle
/// A farther neighbourhood is chosen only if it is better by this factor: curved surfaces are not followed to their
/// flattest place.
constexpr double kClearlyLess = .7;
constexpr double kTrust = 3;         ///< deviations by which a sample's normal may differ from its guide
constexpr double kLeastTrust = .35;  ///< radians (20 degrees): the turn of a radius of 5 spacings within two
constexpr double kFirstScale = 2.5, kNextScale = 1.2;  ///< of angles that count as one deviation, in units of the tilt
constexpr int kPasses = 3;
constexpr double kLeastVariance = 1e-5;  ///< of positions from a plane, squared spacings: smaller ones are all alike

Vec3 unit_or(const Vec3& sum, const Vec3& otherwise) {
  const double length = sum.norm();
  return length > 1e-12 ? Vec3(sum / length) : otherwise;
}

std::span<const std::uint32_t> around(const Neighbourhoods& near, std::size_t i) {
  return near.points(i).first(std::min(kAround, near.k()));
}

/// The sum of the normals around every sample.
std::vector<Vec3> sums(const std::vector<Vec3>& normals, const Neighbourhoods& near) {
  std::vector<Vec3> result(normals);
  tbb::parallel_for(std::size_t{0}, normals.size(), [&](std::size_t i) {
    for (const std::uint32_t j : around(near, i)) result[i] += normals[j];
  });
  return result;
}

/// For every sample, the neighbourhood of least cost that contains it, as the sample in its middle.
std::vector<std::uint32_t> most_consistent(const std::vector<double>& cost, const Neighbourhoods& near) {
  std::vector<std::uint32_t> chosen(cost.size());
  tbb::parallel_for(std::size_t{0}, cost.size(), [&](std::size_t i) {
    auto best = static_cast<std::uint32_t>(i);
    for (const std::uint32_t j : around(near, i))
      if (cost[j] < kClearlyLess * cost[best]) best = j;
    chosen[i] = best;
  });
  return chosen;
}

/// First guides of the filter: the mean normal of the most consistent neighbourhood among those that agree with the
/// sample's own normal up to an angle. Without any it is this normal, as on faces that are narrower than
/// neighbourhoods.
std::vector<Vec3> guides(const std::vector<Vec3>& normals, const std::vector<Vec3>& means,
                         const std::vector<double>& cost, const Neighbourhoods& near, double angle) {
  std::vector<Vec3> result(normals);
  tbb::parallel_for(std::size_t{0}, normals.size(), [&](std::size_t i) {
    double least = std::numeric_limits<double>::infinity();
    const auto consider = [&](std::size_t j) {
      if (!(cost[j] < kClearlyLess * least)) return;
      const Vec3 mean = unit_or(means[j], normals[i]);
      if (angle_between(mean, normals[i]) > angle) return;
      least = cost[j];
      result[i] = mean;
    };
    consider(i);
    for (const std::uint32_t j : around(near, i)) consider(j);
  });
  return result;
}

/// One pass: means of normals around, weighted by their distance and by the angle of the normals
/// that are compared with the guide.
std::vector<Vec3> weighted_means(const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
                                 const std::vector<Vec3>& compared, const std::vector<Vec3>& guides,
                                 const Neighbourhoods& near, double scale) {
  constexpr double kReach = 1.5;  // spacings: the standard deviation of the weights by distance
  std::vector<Vec3> result(normals.size());
  tbb::parallel_for(std::size_t{0}, normals.size(), [&](std::size_t i) {
    const auto weight = [&](std::size_t j) {
      const double d2 = (points[j] - points[i]).squaredNorm() / (kReach * kReach);
      const double a = angle_between(compared[j], guides[i]) / scale;
      return std::exp(-.5 * (d2 + a * a));
    };
    Vec3 sum = weight(i) * normals[i];
    for (const std::uint32_t j : near.points(i).first(std::min<std::size_t>(24, near.k())))
      sum += weight(j) * normals[j];
    result[i] = unit_or(sum, guides[i]);
  });
  return result;
}

}  // namespace

FilteredNormals filter_normals(const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
                               const Neighbourhoods& near) {
  const std::size_t n = points.size();
  const std::vector<Vec3> means = sums(normals, near);
  std::vector<double> cost(n);
  const double in_mean = 1 + static_cast<double>(std::min(kAround, near.k()));
  for (std::size_t i = 0; i < n; ++i) cost[i] = std::max(1e-6, 1 - means[i].norm() / in_mean);
  const std::vector<std::uint32_t> chosen = most_consistent(cost, near);
  std::vector<double> least(n);
  for (std::size_t i = 0; i < n; ++i) least[i] = cost[chosen[i]];
  // The expectation of the cosine of a tilt is 1 - tilt^2.
  double tilt = std::sqrt(median(least));
  FilteredNormals result;
  result.normals.resize(n);
  result.normals = guides(normals, means, cost, near, std::max(kLeastTrust, kTrust * tilt));
  for (int pass = 0; pass < kPasses; ++pass) {
    // In the first pass a measured normal is compared with the guide, then its filtered normal, which has less noise.
    const double scale = pass == 0 ? kFirstScale : kNextScale;
    const std::vector<Vec3>& compared = pass == 0 ? normals : result.normals;
    result.normals = weighted_means(points, normals, compared, result.normals, near,
                                    std::clamp(scale * tilt, kLeastScale, kLargestScale));
    std::vector<double> angles(n);
    for (std::size_t i = 0; i < n; ++i) angles[i] = angle_between(normals[i], result.normals[i]);
    tilt = median(std::move(angles)) / 1.177;  // the median of the length of two normal deviates
  }
  result.tilt = tilt;
  return result;
}

FilteredNormals estimate_edged_normals(const std::vector<Vec3>& points, const std::vector<Vec3>& sides,
                                       const Neighbourhoods& near) {
  const std::size_t n = points.size();
  const std::vector<Vec3> means = sums(sides, near);
  std::vector<Vec3> planes(n);
  std::vector<double> cost(n);
  tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
    Vec3 mean = Vec3::Zero();
    Mat3 squares = Mat3::Zero();
    const auto add = [&](std::size_t j) {
      const Vec3 d = points[j] - points[i];
      mean += d;
      squares.noalias() += d * d.transpose();
    };
    for (const std::uint32_t j : around(near, i)) add(j);
    const double count = 1 + static_cast<double>(around(near, i).size());
    mean /= count;
    Eigen::SelfAdjointEigenSolver<Mat3> axes;
    axes.computeDirect(squares / count - mean * mean.transpose());
    planes[i] = axes.eigenvectors().col(0).normalized();
    if (planes[i].dot(means[i]) < 0) planes[i] = -planes[i];
    cost[i] = std::max(kLeastVariance, axes.eigenvalues()[0]);
  });
  const std::vector<std::uint32_t> chosen = most_consistent(cost, near);
  FilteredNormals result;
  result.tilt = std::numeric_limits<double>::infinity();
  result.normals.resize(n);
  std::vector<double> least(n);
  for (std::size_t i = 0; i < n; ++i) least[i] = cost[chosen[i]];
  const SheetSamples samples{points, sides, std::sqrt(median(std::move(least))), result.tilt};
  tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
    const std::uint32_t j = chosen[i];
    std::array<std::uint32_t, kAround + 1> members;
    const std::span<const std::uint32_t> others = around(near, j);
    std::copy(others.begin(), others.end(), members.begin());
    members[others.size()] = j;
    const LocalSheet sheet(samples, points[j], planes[j], std::span(members).first(others.size() + 1));
    result.normals[i] = sheet.normal(points[i]);
  });
  const std::vector<Vec3> once = result.normals;
  result.normals = weighted_means(points, once, once, once, near, kLeastScale);
  return result;
}

}  // namespace umtet
