#pragma once

// Clouds sampled from shapes whose distance is known.

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "reconstruct/cloud/point_cloud.h"

namespace umtet::test {

inline constexpr double kTorusR = 1, kTorusr = 0.4;

/// Signed distance to the torus R = 1, r = .4 about the z axis.
inline double torus_distance(const Vec3& x) { return std::hypot(std::hypot(x[0], x[1]) - kTorusR, x[2]) - kTorusr; }

/// n points of the torus, uniform by area, with exact normals.
inline OrientedPointCloud torus_cloud(int n, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  OrientedPointCloud cloud;
  while (static_cast<int>(cloud.points.size()) < n) {
    const double u = 2 * std::numbers::pi * unit(random), v = 2 * std::numbers::pi * unit(random);
    if (unit(random) * (kTorusR + kTorusr) > kTorusR + kTorusr * std::cos(v)) continue;
    const Vec3 normal(std::cos(u) * std::cos(v), std::sin(u) * std::cos(v), std::sin(v));
    cloud.points.push_back(Vec3(std::cos(u), std::sin(u), 0) * kTorusR + kTorusr * normal);
    cloud.normals.push_back(normal);
  }
  return cloud;
}

/// Regular samples of the six faces of the box from 0 to `size`, none on an edge.
inline OrientedPointCloud box_cloud(const Vec3& size, double spacing) {
  OrientedPointCloud cloud;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const double n_u = std::round(size[u] / spacing), n_v = std::round(size[v] / spacing);
    for (int i = 0; i < n_u; ++i) {
      for (int j = 0; j < n_v; ++j) {
        for (int side = 0; side < 2; ++side) {
          Vec3 x;
          x[axis] = side * size[axis], x[u] = (i + .5) / n_u * size[u], x[v] = (j + .5) / n_v * size[v];
          cloud.points.push_back(x);
          cloud.normals.emplace_back((2 * side - 1) * Vec3::Unit(axis));
        }
      }
    }
  }
  return cloud;
}

/// n x n points of the plane through the origin with the given unit normal, side 1.
inline OrientedPointCloud plane_cloud(int n, const Vec3& normal) {
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
  OrientedPointCloud cloud;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      cloud.points.push_back(((i + 0.5) / n - 0.5) * u + ((j + 0.5) / n - 0.5) * v);
      cloud.normals.push_back(normal);
    }
  return cloud;
}

}  // namespace umtet::test
