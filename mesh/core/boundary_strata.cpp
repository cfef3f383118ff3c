#include "mesh/core/boundary_strata.h"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace umtet {
namespace {

constexpr int kMostSteps = 30;        // of Newton's method; it converges in three or four from within h
constexpr double kArrived = 1e-11;    // in h; the step that follows squares what is left
constexpr double kFarthest = 2;       // in h, from where the method starts
constexpr double kLeastSine = 1e-3;   // of the angle between two patches: below it they are parallel
constexpr double kOnBoundary = 1e-6;  // in h: where psi is larger, a point of a patch is beyond its curves
constexpr double kKeptFromEnd = .05;  // in h: a curve vertex stays this far from the plane through an end

/// Whether a point of the zero set of a patch is on the boundary, and not beyond the curves of the patch.
/// @param slope  of the patch there
bool is_on_boundary(const PiecewiseDomain& domain, const Vec3& x, double slope, double h) {
  return std::abs(domain.value(x)) <= kOnBoundary * h * slope;
}

}  // namespace

double BoundaryStrata::value(int patch, const Vec3& x, Vec3* gradient) const {
  if (patch < 0) return domain_->evaluate(x, gradient, nullptr);
  const double value = domain_->patch(patch, x, gradient);
  const int side = domain_->side(patch);
  if (gradient) *gradient *= side;
  return side * value;
}

/// Returns the two patches of a curve whose gradients at x are farthest from parallel. With more than two patches, any
/// two of them describe the curve.
std::pair<BoundaryStrata::UnitPatch, BoundaryStrata::UnitPatch> BoundaryStrata::steepest_pair(const Stratum& s,
                                                                                              const Vec3& x) const {
  std::vector<UnitPatch> all(s.patches.size());
  for (std::size_t k = 0; k < all.size(); ++k) {
    all[k].value = value(s.patches[k], x, &all[k].gradient);
    const double norm = all[k].gradient.norm();
    all[k].value /= norm;
    all[k].gradient /= norm;
  }
  std::pair<std::size_t, std::size_t> best{0, 1};
  double least = 2;
  for (std::size_t a = 1; a < all.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      if (const double cosine = std::abs(all[a].gradient.dot(all[b].gradient)); cosine < least)
        least = cosine, best = {b, a};
  return {all[best.first], all[best.second]};
}

FreeDirections BoundaryStrata::directions(int stratum, const Vec3& x) const {
  FreeDirections free;
  const Stratum& s = strata_[stratum];
  if (s.dimension == 0) return free;
  if (s.course) {
    free.n = 1;
    free.tangents.col(0) = s.course->nearest(x).tangent;
    return free;
  }
  if (s.patches.size() > 2) {
    const auto [a, b] = steepest_pair(s, x);
    const Vec3 along = a.gradient.cross(b.gradient);
    const double sine = along.norm();
    if (!(sine > kLeastSine)) return free;
    free.n = 1;
    free.tangents.col(0) = along / sine;
    return free;
  }
  Vec3 g;
  value(s.patches.empty() ? -1 : s.patches[0], x, &g);
  const double norm = g.norm();
  if (!(norm > 0) || !std::isfinite(norm)) return free;
  g /= norm;
  if (s.dimension == 2) {
    free.n = 2;
    free.tangents.col(0) = g.unitOrthogonal();
    free.tangents.col(1) = g.cross(free.tangents.col(0));
    return free;
  }
  Vec3 other;
  value(s.patches[1], x, &other);
  const Vec3 along = g.cross(other.normalized());
  const double sine = along.norm();
  if (!(sine > kLeastSine)) return free;
  free.n = 1;
  free.tangents.col(0) = along / sine;
  free.tangents.col(1).setZero();
  return free;
}

BallOnPatch BoundaryStrata::ball_on_patch(int stratum, const Vec3& x, double h) const {
  const Stratum& s = strata_[stratum];
  if (s.dimension != 2 || !s.border) return {x, 0};
  Vec3 gradient;
  value(s.patches[0], x, &gradient);
  if (!is_on_boundary(*domain_, x, gradient.norm(), h)) return {x, 0};
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& curve : *s.border) nearest = std::min(nearest, curve->nearest(x).distance);
  return {x, nearest / 2};
}

bool BoundaryStrata::foot(int stratum, const Vec3& x, double h, Vec3& place, const BallOnPatch* ball) const {
  const Stratum& s = strata_[stratum];
  if (s.dimension == 0) {
    place = s.place;
    return (place - x).norm() <= kFarthest * h;
  }
  Vec3 y = x;
  const int n = s.dimension == 2 ? 1 : 2;
  bool has_arrived = false;
  double slope = 0;  // of a patch
  if (s.course) {
    y = s.course->nearest(x).point;
    has_arrived = (y - x).squaredNorm() <= kFarthest * kFarthest * h * h;
  }
  for (int k = 0; k < kMostSteps && !s.course; ++k) {
    Vec3 step;
    double off;
    if (n == 1) {
      Vec3 g;
      const double f = value(s.patches.empty() ? -1 : s.patches[0], y, &g);
      const double g2 = g.squaredNorm();
      if (!(g2 > 0) || !std::isfinite(f)) return false;
      slope = std::sqrt(g2);
      step = -f / g2 * g;
      off = step.norm();
    } else {
      Vec3 a, b;
      double fa, fb;
      if (s.patches.size() > 2) {
        const auto [first, second] = steepest_pair(s, y);
        a = first.gradient, b = second.gradient, fa = first.value, fb = second.value;
        if (!a.allFinite() || !b.allFinite() || !std::isfinite(fa) || !std::isfinite(fb)) return false;
      } else {
        fa = value(s.patches[0], y, &a), fb = value(s.patches[1], y, &b);
        const double la = a.norm(), lb = b.norm();
        if (!(la > 0 && lb > 0) || !std::isfinite(fa) || !std::isfinite(fb)) return false;
        a /= la, b /= lb, fa /= la, fb /= lb;
      }
      const double c = a.dot(b), det = 1 - c * c;
      if (!(det > kLeastSine * kLeastSine)) return false;
      step = -((fa - c * fb) / det * a + (fb - c * fa) / det * b);
      off = std::max(std::abs(fa), std::abs(fb));
    }
    const double length = step.norm();
    if (length > h) step *= h / length;
    y += step;
    if ((y - x).squaredNorm() > kFarthest * kFarthest * h * h) return false;
    if (off <= kArrived * h) {
      has_arrived = true;
      break;
    }
  }
  if (!has_arrived) return false;
  if (n == 1 && !s.patches.empty() && domain_->n_patches() > 1) {
    // Beyond its curves the zero set goes on, but not the boundary.
    const bool is_known = ball && (y - ball->centre).norm() < ball->radius;
    if (!is_known && !is_on_boundary(*domain_, y, slope, h)) return false;
  }
  for (const Stratum::End& end : s.ends) {
    const Vec3 d = y - end.place;
    if (d.squaredNorm() < end.within * end.within && d.dot(end.tangent) < kKeptFromEnd * h) return false;
  }
  place = y;
  return true;
}

double BoundaryStrata::distance(int stratum, const Vec3& x) const {
  const Stratum& s = strata_[stratum];
  if (s.dimension == 0) return (x - s.place).norm();
  if (s.course) return (x - s.course->nearest(x).point).norm();
  const auto off = [&](int patch) {
    Vec3 g;
    const double f = value(patch, x, &g);
    return std::abs(f) / g.norm();
  };
  if (s.patches.empty()) return off(-1);
  double farthest = 0;
  for (const int p : s.patches) farthest = std::max(farthest, off(p));
  return farthest;
}

int BoundaryStrata::patch_of(int a, int b, int c) const {
  const std::vector<int>&A = strata_[a].patches, &B = strata_[b].patches, &C = strata_[c].patches;
  if (A.empty() || B.empty() || C.empty()) return -1;
  int found = -2;
  for (const int p : A) {
    if (!std::binary_search(B.begin(), B.end(), p) || !std::binary_search(C.begin(), C.end(), p)) continue;
    if (found >= 0) return -2;
    found = p;
  }
  return found;
}

bool BoundaryStrata::is_in_closure(int a, int b) const {
  if (a == b) return true;
  const Stratum &A = strata_[a], &B = strata_[b];
  if (A.dimension >= B.dimension || A.patches.empty() || B.patches.empty()) return false;
  return std::includes(A.patches.begin(), A.patches.end(), B.patches.begin(), B.patches.end());
}

}  // namespace umtet
