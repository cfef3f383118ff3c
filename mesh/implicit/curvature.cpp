#include "mesh/implicit/curvature.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace umtet {
namespace {

// (|k1| + |k2|) h^2 / kFlatness is the largest distance of a face from psi = 0: see the header.
constexpr double kFlatness = 6.8;

/// The unit normal at a point of psi = 0 near x, after one step of Newton's method; zero where there is none.
Vec3 normal_near(ImplicitFunctionRef psi, const Vec3& x) {
  Vec3 g;
  const double value = psi.value(x, g);
  const double slope2 = g.squaredNorm();
  if (!std::isfinite(value) || !(slope2 > 0) || !std::isfinite(slope2)) return Vec3::Zero();
  g = psi.gradient(x - value / slope2 * g);
  const double slope = g.norm();
  return slope > 0 && std::isfinite(slope) ? Vec3(g / slope) : Vec3::Zero();
}

}  // namespace

Eigen::Vector2d principal_curvatures(ImplicitFunctionRef psi, const Vec3& x) {
  Vec3 g;
  Mat3 H;
  psi.value(x, g, H);
  const Vec3 n = g.normalized();
  const Mat3 P = Mat3::Identity() - n * n.transpose();
  // P H P / |grad psi| is the shape operator, with a third eigenvalue 0 along the normal.
  const Mat3 S = P * H * P / g.norm();
  Vec3 k = Eigen::SelfAdjointEigenSolver<Mat3>(S, Eigen::EigenvaluesOnly).eigenvalues().cwiseAbs();
  std::sort(k.data(), k.data() + 3);
  return {k[2], k[1]};
}

double edge_of_deviation(const Eigen::Vector2d& curvatures, double deviation) {
  const double k = curvatures.allFinite() ? curvatures.cwiseMin(1 / deviation).sum() : 0;
  return k > 0 ? std::sqrt(kFlatness * deviation / k) : std::numeric_limits<double>::infinity();
}

double turn_along(ImplicitFunctionRef psi, const Vec3& x, const Vec3& n, double h) {
  const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
  Eigen::Matrix<double, 3, 2> D;  // what a step in the tangent plane changes of n
  for (int k = 0; k < 2; ++k) {
    const Vec3 d = h / 2 * (k == 0 ? u : v);
    const Vec3 a = normal_near(psi, x + d), b = normal_near(psi, x - d);
    D.col(k) = a.isZero() || b.isZero() ? Vec3(Vec3::Zero()) : Vec3(a - b);
  }
  const Eigen::Matrix2d M = D.transpose() * D;
  const double largest = M.trace() / 2 + std::hypot((M(0, 0) - M(1, 1)) / 2, M(0, 1));  // eigenvalue
  return 2 * std::asin(std::min(1., std::sqrt(largest) / 2));
}

}  // namespace umtet
