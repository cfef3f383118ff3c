#include "reconstruct/patches/local_sheet.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace umtet {
namespace {

using Row = Eigen::Matrix<double, 6, 1>;

// Standard deviations of the prior of slopes and of half curvatures (1 / sample spacings). It decides what few samples
// on one side of a border leave open. A hole with a radius of 1.7 spacings has half curvatures of .3.
constexpr double kSlope = .5, kHalfCurvature = .3;

// Slopes are not a measure of a normal that is nearly in the plane: cos 72 degrees.
constexpr double kLeastCosine = .3;

constexpr double kOutlying = 2.5;  ///< deviations: a member farther away has less than a quarter of its weight
constexpr std::size_t kMostMembers = 64;

}  // namespace

LocalSheet::LocalSheet(const SheetSamples& samples, const Vec3& origin, const Vec3& up,
                       std::span<const std::uint32_t> members)
    : origin_(origin), u_(up.unitOrthogonal()), v_(up.cross(u_)), w_(up), c_(Row::Zero()) {
  fit(samples, members, std::numeric_limits<double>::infinity());
  if (members.size() < 8) return;
  std::array<double, kMostMembers> sizes;
  const std::size_t n = std::min(members.size(), kMostMembers);
  for (std::size_t k = 0; k < n; ++k) sizes[k] = std::abs(distance(samples.points[members[k]]));
  std::nth_element(sizes.begin(), sizes.begin() + n / 2, sizes.begin() + n);
  residual_ = sizes[n / 2];
  fit(samples, members.first(n), kOutlying * std::max(samples.noise, 1.5 * residual_));
}

void LocalSheet::fit(const SheetSamples& samples, std::span<const std::uint32_t> members, double outlying) {
  Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
  Row b = Row::Zero();
  const double per_position = 1 / (samples.noise * samples.noise);
  const double per_slope = 1 / (samples.tilt * samples.tilt);
  for (const std::uint32_t i : members) {
    const Vec3 d = samples.points[i] - origin_;
    const double x = d.dot(u_), y = d.dot(v_), z = d.dot(w_);
    const double far = std::isfinite(outlying) ? distance(samples.points[i]) / outlying : 0;
    const double weight = 1 / ((1 + far * far) * (1 + far * far));
    Row row;
    row << 1, x, y, x * x, x * y, y * y;
    A.noalias() += weight * per_position * row * row.transpose();
    b += weight * per_position * z * row;
    if (per_slope == 0) continue;
    const Vec3& n = samples.normals[i];
    const double cosine = n.dot(w_);
    if (cosine < kLeastCosine) continue;
    // d(slope) = d(angle) / cos^2 in the worst direction.
    const double on_slope = weight * per_slope * cosine * cosine * cosine * cosine;
    Row along, across;
    along << 0, 1, 0, 2 * x, y, 0;
    across << 0, 0, 1, 0, x, 2 * y;
    A.noalias() += on_slope * (along * along.transpose() + across * across.transpose());
    b -= on_slope / cosine * (n.dot(u_) * along + n.dot(v_) * across);
  }
  A(0, 0) += 1e-6 * per_position;  // defines the solution for no members
  for (int k = 1; k < 3; ++k) A(k, k) += 1 / (kSlope * kSlope);
  for (int k = 3; k < 6; ++k) A(k, k) += 1 / (kHalfCurvature * kHalfCurvature);
  c_ = A.llt().solve(b);
}

double LocalSheet::distance(const Vec3& at) const {
  const Vec3 d = at - origin_;
  const double x = d.dot(u_), y = d.dot(v_);
  const double p = c_[1] + 2 * c_[3] * x + c_[4] * y, q = c_[2] + c_[4] * x + 2 * c_[5] * y;
  const double z = c_[0] + x * (c_[1] + c_[3] * x + c_[4] * y) + y * (c_[2] + c_[5] * y);
  return (d.dot(w_) - z) / std::sqrt(1 + p * p + q * q);
}

Vec3 LocalSheet::normal(const Vec3& at) const {
  const Vec3 d = at - origin_;
  const double x = d.dot(u_), y = d.dot(v_);
  const double p = c_[1] + 2 * c_[3] * x + c_[4] * y, q = c_[2] + c_[4] * x + 2 * c_[5] * y;
  return (w_ - p * u_ - q * v_).normalized();
}

}  // namespace umtet
