#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <vector>

namespace umtet::testing {

/// Points at the walls |x| = width and |y| = width and the cap |z| = length, where all coordinates are positive: the
/// middles of squares, n across.
inline std::vector<Eigen::Vector3d> octant_of_duct(int n, double width, double length) {
  std::vector<Eigen::Vector3d> points;
  const double step = width / n;
  for (int i = 0; i < n; ++i) {
    const double across = (i + .5) * step;
    for (double z = step / 2; z < length; z += step) {
      points.emplace_back(width, across, z);
      points.emplace_back(across, width, z);
    }
    for (int j = 0; j < n; ++j) points.emplace_back(across, (j + .5) * step, length);
  }
  return points;
}

/// Those of 8 n points on a spiral about the sphere that have positive coordinates.
inline std::vector<Eigen::Vector3d> octant_of_sphere(int n, double radius) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 8 * n; ++i) {
    const double z = 1 - (2 * i + 1.) / (8 * n), r = std::sqrt(1 - z * z);
    const double turn = 2 * std::numbers::pi * std::numbers::phi * i;
    const Eigen::Vector3d x(r * std::cos(turn), r * std::sin(turn), z);
    if (x.minCoeff() > 0) points.push_back(radius * x);
  }
  return points;
}

/// Velocity at x of a force f at `at` and of its images in the planes of symmetry, viscosity 1: the matrix that takes f
/// to it. The flow along z is even in x and in y; across, it is odd in z and in its own coordinate.
inline Eigen::Matrix3d flow_of_force(const Eigen::Vector3d& x, const Eigen::Vector3d& at) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int image = 0; image < 8; ++image) {
    const Eigen::Vector3d sign(image & 1 ? -1 : 1, image & 2 ? -1 : 1, image & 4 ? -1 : 1);
    const Eigen::Vector3d d = x - sign.cwiseProduct(at), f(sign.x() * sign.z(), sign.y() * sign.z(), 1);
    const double r = d.norm();
    sum += (Eigen::Matrix3d::Identity() / r + d * d.transpose() / (r * r * r)) * f.asDiagonal();
  }
  return sum / (8 * std::numbers::pi);
}

/// Drag over 6 pi mu a U of a sphere of radius a that moves along the axis of the square duct |x|, |y| <= 1 at its
/// middle; the fluid is at rest at the walls and far away. By fundamental solutions of Stokes' equations: forces
/// outside the duct and inside the sphere, least squares for the velocities on both. The duct is closed at |z| = 3.
/// Holds to some 1e-3.
inline double drag_in_duct(double a) {
  std::vector<Eigen::Vector3d> forces = octant_of_duct(5, 1.5, 3.5), places = octant_of_duct(8, 1, 3);
  const std::size_t n_outside = forces.size(), n_wall = places.size();
  for (const Eigen::Vector3d& x : octant_of_sphere(14, .5 * a)) forces.push_back(x);
  for (const Eigen::Vector3d& x : octant_of_sphere(42, a)) places.push_back(x);
  Eigen::MatrixXd A(3 * places.size(), 3 * forces.size());
  Eigen::VectorXd u = Eigen::VectorXd::Zero(A.rows());
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (i >= n_wall) u[3 * long(i) + 2] = 1;
    for (std::size_t j = 0; j < forces.size(); ++j) {
      A.block<3, 3>(3 * long(i), 3 * long(j)) = flow_of_force(places[i], forces[j]);
    }
  }
  const Eigen::VectorXd f = A.colPivHouseholderQr().solve(u);
  double drag = 0;
  for (std::size_t j = n_outside; j < forces.size(); ++j) drag += 8 * f[3 * long(j) + 2];
  return drag / (6 * std::numbers::pi * a);
}

}  // namespace umtet::testing
