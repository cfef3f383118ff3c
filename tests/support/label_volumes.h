#pragma once

#include <cmath>
#include <functional>

#include "reconstruct/level_set/grid.h"

namespace umtet {

/// Voxels whose centre f says to be inside, in an image of n voxels of these steps with its middle at 0.
inline Grid label_volume_of(const Eigen::Vector3i& n, const Vec3& steps, const std::function<double(const Vec3&)>& f) {
  Grid grid;
  grid.n = n;
  grid.axes = steps.asDiagonal();
  grid.origin = -.5 * grid.axes * (n.cast<double>() - Vec3::Ones());
  grid.is_whole = true;
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) grid.values.push_back(f(grid.origin + grid.axes * Vec3(i, j, k)));
    }
  }
  return grid;
}

/// A slanted direction: no plane or line along it has a period in a grid that is seen.
inline Vec3 slanted() { return Vec3(1, .23, .41).normalized(); }

/// Bodies that a kernel makes thinner or takes away, 1 inside.
inline double is_in_ball(const Vec3& x, double R) { return x.norm() < R ? 1 : 0; }
inline double is_in_shell(const Vec3& x, double inner, double outer) {
  return x.norm() < outer && x.norm() > inner ? 1 : 0;
}
inline double is_in_vessel(const Vec3& x, double R, double half_length) {
  const double along = x.dot(slanted());
  return std::abs(along) < half_length && (x - along * slanted()).norm() < R ? 1 : 0;
}
inline double is_in_plate(const Vec3& x, double thickness, double R) {
  const double across = x.dot(slanted()) - .1;
  return std::abs(across) < thickness / 2 && (x - x.dot(slanted()) * slanted()).norm() < R ? 1 : 0;
}

}  // namespace umtet
