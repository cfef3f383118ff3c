#include "reconstruct/patches/patch_zero_sets.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace umtet {
namespace {

constexpr double kArrived = 1e-11;  // in spacings
constexpr int kMostNewton = 30;
constexpr double kParallel = 1e-3;  // sine of the angle of two patches
constexpr double kFlat = .05;       // least singular value of three normals that define a corner

}  // namespace

double PatchZeroSets::distance(int p, const Vec3& x, Vec3& normal) const {
  const double f = fits_[p].evaluate(x, &normal, nullptr), slope = normal.norm();
  normal /= slope;
  return f / slope;
}

bool PatchZeroSets::correct(std::span<const int> patches, Vec3& x, double farthest, double* off) const {
  const auto n = static_cast<Eigen::Index>(patches.size());
  const Vec3 start = x;
  Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 2 * kMostPatchesAtCorner, 3> J(n, 3);
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 2 * kMostPatchesAtCorner, 1> f(n);
  for (int k = 0; k < kMostNewton; ++k) {
    for (Eigen::Index i = 0; i < n; ++i) {
      Vec3 normal;
      f[i] = distance(patches[static_cast<std::size_t>(i)], x, normal);
      J.row(i) = normal.transpose();
    }
    if (!f.allFinite() || !J.allFinite()) return false;
    const auto svd = J.jacobiSvd(Eigen::ComputeThinU | Eigen::ComputeThinV);
    const double least = svd.singularValues()[std::min<Eigen::Index>(n, 3) - 1];
    if (!(least > (n == 2 ? kParallel : kFlat))) return false;
    Vec3 step = -svd.solve(f);
    if (step.norm() > s_) step *= s_ / step.norm();
    x += step;
    if ((x - start).norm() > farthest) return false;
    // Of more than three equations the residual is left; the method converges to it linearly.
    if (step.norm() <= (n > 3 ? 1e-6 : kArrived) * s_) {
      if (off) *off = f.cwiseAbs().maxCoeff();
      return true;
    }
  }
  return false;
}

double PatchZeroSets::angle_deg(const std::array<int, 2>& pair, const Vec3& x, bool is_convex) const {
  Vec3 a, b;
  distance(pair[0], x, a);
  distance(pair[1], x, b);
  const double turn = std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi;
  return is_convex ? 180 - turn : 180 + turn;
}

std::optional<Vec3> PatchZeroSets::tangent(const std::array<int, 2>& pair, const Vec3& x) const {
  Vec3 a, b;
  distance(pair[0], x, a);
  distance(pair[1], x, b);
  const Vec3 t = a.cross(b);
  const double sine = t.norm();
  if (!(sine > kParallel)) return std::nullopt;
  return Vec3(t / sine);
}

}  // namespace umtet
