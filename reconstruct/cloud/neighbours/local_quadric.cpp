#include "reconstruct/cloud/neighbours/local_quadric.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

namespace umtet {

LocalQuadric local_quadric(const std::vector<Vec3>& points, const Vec3& x, std::span<const Neighbour> near) {
  LocalQuadric quadric;
  double radius2 = 0;
  Vec3 mean = Vec3::Zero();
  for (const Neighbour& other : near) {
    radius2 = std::max(radius2, other.distance2);
    mean += points[other.point] - x;
  }
  if (near.size() < 3 || !(radius2 > 0)) return quadric;
  const double radius = std::sqrt(radius2), n = static_cast<double>(near.size());
  mean /= n * radius;
  Mat3 covariance = Mat3::Zero();
  for (const Neighbour& other : near) {
    const Vec3 d = (points[other.point] - x) / radius - mean;
    covariance.noalias() += d * d.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Mat3> axes;
  axes.computeDirect(covariance);
  const Vec3 w = axes.eigenvectors().col(0).normalized(), u = w.unitOrthogonal(), v = w.cross(u);
  const double least = std::max(0.0, axes.eigenvalues()[0]);
  quadric.normal = w;
  quadric.variance = least / std::max(1.0, n - 3) * radius2;
  if (near.size() <= kQuadricCoefficients) return quadric;

  using Row = Eigen::Matrix<double, kQuadricCoefficients, 1>;
  using Matrix = Eigen::Matrix<double, kQuadricCoefficients, kQuadricCoefficients>;
  Matrix A = Matrix::Zero();
  Row b = Row::Zero();
  double hh = 0;
  for (const Neighbour& other : near) {
    const Vec3 d = (points[other.point] - x) / radius;
    const double s = d.dot(u), t = d.dot(v), h = d.dot(w);
    Row row;
    row << 1, s, t, s * s, s * t, t * t;
    A.noalias() += row * row.transpose();
    b += h * row;
    hh += h * h;
  }
  const Eigen::LDLT<Matrix> factors(A);
  const auto D = factors.vectorD();
  // Columns are of the order of 1: a pivot this small against the number of rows means that the neighbours lie on a
  // conic, where the slope could be anything.
  constexpr double kDegenerate = 1e-6;
  if (factors.info() != Eigen::Success || D.minCoeff() < kDegenerate * n) return quadric;
  const Row c = factors.solve(b);
  // |slope| > 1: the neighbours have no plane to be a graph over.
  if (!(std::hypot(c[1], c[2]) < 1)) return quadric;
  quadric.normal = (w - c[1] * u - c[2] * v).normalized();
  const double cosine2 = 1 / (1 + c[1] * c[1] + c[2] * c[2]);
  quadric.variance = std::max(0.0, hh - c.dot(b)) * cosine2 / (n - kQuadricCoefficients) * radius2;
  return quadric;
}

}  // namespace umtet
