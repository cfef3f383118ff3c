#pragma once

// Clouds sampled from the analytic domains, and what scanners do to them.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "reconstruct/cloud/point_cloud.h"
#include "tests/support/domains.h"

namespace umtet::test {

/// n points of the zero set of a domain with exact normals, uniform by area: where random lines cross it.
inline OrientedPointCloud sampled(const testing::AnalyticDomain& domain, std::size_t n, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> gauss;
  const Vec3 middle = domain.box.center();
  const double radius = domain.box.diagonal().norm() / 2;
  constexpr int kSteps = 200;
  OrientedPointCloud cloud;
  while (cloud.points.size() < n) {
    const Vec3 d = Vec3(gauss(random), gauss(random), gauss(random)).normalized(), u = d.unitOrthogonal();
    const double r = radius * std::sqrt(unit(random)), angle = 2 * std::numbers::pi * unit(random);
    const Vec3 start = middle + r * (std::cos(angle) * u + std::sin(angle) * d.cross(u)) - radius * d;
    const double step = 2 * radius / kSteps;
    for (int s = 0; s < kSteps; ++s) {
      double t0 = s * step, t1 = t0 + step;
      if (!domain.box.contains(start + t0 * d) || !domain.box.contains(start + t1 * d)) continue;
      const bool inside0 = domain.value(start + t0 * d) < 0;
      if (inside0 == (domain.value(start + t1 * d) < 0)) continue;
      for (int halving = 0; halving < 50; ++halving) {
        const double t = (t0 + t1) / 2;
        ((domain.value(start + t * d) < 0) == inside0 ? t0 : t1) = t;
      }
      if (cloud.points.size() == n) break;
      cloud.points.push_back(start + t0 * d);
      cloud.normals.push_back(domain.gradient(cloud.points.back()).normalized());
    }
  }
  return cloud;
}

inline double box_diagonal(const std::vector<Vec3>& points) {
  Eigen::AlignedBox3d box;
  for (const Vec3& x : points) box.extend(x);
  return box.diagonal().norm();
}

/// Gaussian noise of the given standard deviation along each axis; normals stay.
inline OrientedPointCloud with_noise(OrientedPointCloud cloud, double sigma, std::uint64_t seed = 3) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> gauss;
  for (Vec3& x : cloud.points) x += sigma * Vec3(gauss(random), gauss(random), gauss(random));
  return cloud;
}

/// Turns each normal by a Gaussian angle of about the given standard deviation.
inline OrientedPointCloud with_tilted_normals(OrientedPointCloud cloud, double degrees, std::uint64_t seed = 3) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> gauss;
  const double tilt = std::tan(degrees * std::numbers::pi / 180) / std::numbers::sqrt2;
  for (Vec3& n : cloud.normals) n = (n + tilt * Vec3(gauss(random), gauss(random), gauss(random))).normalized();
  return cloud;
}

/// Adds n points, uniform in the box of the cloud.
inline OrientedPointCloud with_outliers(OrientedPointCloud cloud, int n, std::uint64_t seed = 9) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  Eigen::AlignedBox3d box;
  for (const Vec3& x : cloud.points) box.extend(x);
  for (int i = 0; i < n; ++i) {
    cloud.points.push_back(box.min() + box.sizes().cwiseProduct(Vec3(unit(random), unit(random), unit(random))));
    cloud.normals.push_back(Vec3::UnitZ());
  }
  return cloud;
}

/// Turns over about a share of the normals.
inline void turn_some(OrientedPointCloud& cloud, double share, std::uint64_t seed = 5) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  for (Vec3& n : cloud.normals)
    if (unit(random) < share) n = -n;
}

/// Mean and greatest distance of points of a surface to psi = 0 along the gradient.
template <class Psi>
std::pair<double, double> mean_and_max_distance(const Psi& psi, const std::vector<Vec3>& surface) {
  double sum = 0, most = 0;
  for (const Vec3& start : surface) {
    Vec3 x = start, g;
    for (int it = 0; it < 6; ++it) {
      const double f = psi.evaluate(x, &g, nullptr);
      x -= f / g.squaredNorm() * g;
    }
    sum += (x - start).norm();
    most = std::max(most, (x - start).norm());
  }
  return {sum / static_cast<double>(surface.size()), most};
}

/// A sphere of n points added to a cloud; side -1: its normals point to its centre.
inline void add_sphere(OrientedPointCloud& cloud, const Vec3& centre, double radius, int n, double side = 1) {
  for (int i = 0; i < n; ++i) {
    const double z = 1 - (2 * i + 1.0) / n, r = std::sqrt(1 - z * z),
                 angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const Vec3 normal(r * std::cos(angle), r * std::sin(angle), z);
    cloud.points.push_back(centre + radius * normal);
    cloud.normals.push_back(side * normal);
  }
}

/// The unit sphere in circles of latitude `gap` apart, with samples gap / ratio apart along them.
inline OrientedPointCloud ball_in_lines(double gap, double ratio) {
  OrientedPointCloud cloud;
  const int n_lines = static_cast<int>(std::round(std::numbers::pi / gap));
  for (int line = 0; line < n_lines; ++line) {
    const double theta = std::numbers::pi * (line + .5) / n_lines;
    const int n = std::max(3, static_cast<int>(std::round(2 * std::numbers::pi * std::sin(theta) * ratio / gap)));
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * (i + std::fmod(.618 * line, 1)) / n;
      cloud.normals.emplace_back(std::sin(theta) * std::cos(angle), std::sin(theta) * std::sin(angle), std::cos(theta));
      cloud.points.push_back(cloud.normals.back());
    }
  }
  return cloud;
}

}  // namespace umtet::test
