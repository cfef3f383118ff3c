#include "reconstruct/io/detail/extent.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <set>

namespace umtet::detail {
namespace {

constexpr double kSmallest = 1e-50;

}  // namespace

void check_extent(const CloudSource& source, const std::vector<Vec3>& points, std::size_t fewest) {
  constexpr double kFlat = 1e-6;  // rounding of single precision makes a plane 1e-7 of its extent thick
  std::set<std::array<double, 3>> places;
  for (std::size_t i = 0; i < points.size() && places.size() < fewest; ++i)
    places.insert({points[i][0], points[i][1], points[i][2]});
  if (places.size() < fewest) {
    refuse(source, fmt::format("{} points at only {} different places: a surface needs at least {}", points.size(),
                               places.size(), fewest));
  }
  Vec3 mean = Vec3::Zero();
  for (const Vec3& x : points) mean += x / static_cast<double>(points.size());
  double scale = 0;
  for (const Vec3& x : points) scale = std::max(scale, (x - mean).cwiseAbs().maxCoeff());
  if (scale < kSmallest)
    refuse(source,
           fmt::format("the points are within {:.3g} of each other, less than 1e-50: give them in a smaller unit",
                       2 * scale));
  Mat3 spread = Mat3::Zero();
  for (const Vec3& x : points) spread += (x - mean) / scale * ((x - mean) / scale).transpose();
  const Vec3 extent =
      Eigen::SelfAdjointEigenSolver<Mat3>(spread, Eigen::EigenvaluesOnly).eigenvalues().cwiseMax(0).cwiseSqrt();
  if (extent[0] < kFlat * extent[2]) {
    refuse(source, fmt::format("all points lie on one {}: they do not bound a body",
                               extent[1] < kFlat * extent[2] ? "line" : "plane"));
  }
}

}  // namespace umtet::detail
