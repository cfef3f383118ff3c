#include "mesh/second_order/mid_side_relaxation.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <numeric>

#include "mesh/core/tet_quality.h"
#include "mesh/second_order/jacobian_bounds.h"

namespace umtet {
namespace {

constexpr int kSteps = 4;          // of a line search, each half of the one before
constexpr double kProgress = .99;  // a step has to lower the energy to this share of it
constexpr int kHalvings = 4;       // of the way to the chord, before the rest is taken at once

/// Derivatives of the twenty coefficients by the place of local node 4 + k.
std::array<Vec3, 20> derivatives(const JacobianColumns& a, int k) {
  const auto [p, q] = kMidSideEdge[k];
  const auto joins = [p = p, q = q](int i, int j) { return (i == p && j == q) || (i == q && j == p); };
  std::array<std::array<double, 4>, 4> weight{};  // of the node in column a[i][j - 1]
  for (int i = 0; i < 4; ++i) {
    for (int j = 1; j < 4; ++j) weight[i][j] = 4 * (joins(i, j) - joins(i, 0));
  }
  std::array<Vec3, 20> d;
  d.fill(Vec3::Zero());
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      for (int l = 0; l < 4; ++l) {
        Vec3& sum = d[kCubicIndex[i][j][l]];
        if (weight[i][1] != 0) sum += weight[i][1] * a[j][1].cross(a[l][2]);
        if (weight[j][2] != 0) sum += weight[j][2] * a[l][2].cross(a[i][0]);
        if (weight[l][3] != 0) sum += weight[l][3] * a[i][0].cross(a[j][1]);
      }
    }
  }
  for (int n = 0; n < 20; ++n) d[n] /= kCubicOrders[n];
  return d;
}

double straight_jacobian(const QuadraticNodes& x) { return std::abs(volume6(x[0], x[1], x[2], x[3])); }

}  // namespace

MidSideRelaxation::MidSideRelaxation(QuadraticTetMesh& mesh, std::size_t n_corners, std::vector<MidSide>& kind,
                                     ImplicitFunctionRef psi, double h, const SecondOrderParams& params,
                                     const std::vector<char>* at_rim)
    : mesh_(mesh),
      n_corners_(static_cast<int>(n_corners)),
      kind_(kind),
      psi_(psi),
      h_(h),
      params_(params),
      at_rim_(at_rim),
      begin_(kind.size() + 2, 0),
      tets_(6 * mesh.C.size()) {
  const auto for_uses = [&](const auto& f) {
    for (std::size_t t = 0; t < mesh_.C.size(); ++t) {
      for (int k = 4; k < 10; ++k) f(mesh_.C[t][k] - n_corners_, static_cast<int>(t));
    }
  };
  for_uses([&](int m, int) { ++begin_[m + 2]; });
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  for_uses([&](int m, int t) { tets_[begin_[m + 1]++] = t; });
}

std::span<const int> MidSideRelaxation::tets_at(int mid_side) const {
  const int m = mid_side - n_corners_;
  return {tets_.data() + begin_[m], begin_[m + 1] - begin_[m]};
}

Vec3 MidSideRelaxation::chord_middle(int mid_side) const {
  const QuadraticTet& tet = mesh_.C[tets_at(mid_side).front()];
  const auto k = std::find(tet.begin(), tet.end(), mid_side) - tet.begin() - 4;
  const int a = tet[kMidSideEdge[k][0]], b = tet[kMidSideEdge[k][1]];
  return (mesh_.V[a] + mesh_.V[b]) / 2;
}

double MidSideRelaxation::energy(int mid_side) const {
  double sum = 0;
  for (const int t : tets_at(mid_side)) {
    const QuadraticNodes x = nodes_of(mesh_, mesh_.C[t]);
    const double unit = straight_jacobian(x);
    for (const double c : jacobian_coefficients(x).c) {
      const double lack = std::max(0., params_.target - c / unit);
      sum += lack * lack;
    }
  }
  return sum;
}

/// One Gauss-Newton step, as long as it helps.
bool MidSideRelaxation::improve(int mid_side) {
  double E = 0;
  Vec3 g = Vec3::Zero();
  Mat3 H = Mat3::Zero();
  for (const int t : tets_at(mid_side)) {
    const QuadraticTet& tet = mesh_.C[t];
    const QuadraticNodes x = nodes_of(mesh_, tet);
    const double unit = straight_jacobian(x);
    const JacobianCoefficients coefficients = jacobian_coefficients(x);
    const auto k = static_cast<int>(std::find(tet.begin(), tet.end(), mid_side) - tet.begin()) - 4;
    const std::array<Vec3, 20> d = derivatives(jacobian_columns(x), k);
    for (int n = 0; n < 20; ++n) {
      const double lack = params_.target - coefficients.c[n] / unit;
      if (lack <= 0) continue;
      E += lack * lack;
      g -= lack / unit * d[n];
      H += d[n] * d[n].transpose() / (unit * unit);
    }
  }
  if (E == 0) return false;
  const Vec3 start = mesh_.V[mid_side];
  const bool on_surface = kind_[mid_side - n_corners_] == MidSide::Surface;
  const double stiffness = H.trace();
  if (on_surface) {  // no step along the normal
    Vec3 normal;
    psi_.value(start, normal);
    normal.normalize();
    const Mat3 P = Mat3::Identity() - normal * normal.transpose();
    g = P * g;
    H = P * H * P + stiffness * (normal * normal.transpose());
  }
  H += 1e-6 * stiffness * Mat3::Identity();  // directions in which the coefficients do not change
  const Vec3 step = H.ldlt().solve(-g);
  if (!step.allFinite()) return false;
  for (int k = 0; k < kSteps; ++k) {
    Vec3 next = start + std::ldexp(1., -k) * step;
    if (on_surface) {
      const ClosestPoint foot = closest_point(psi_, next, h_, params_.closest_point);
      n_psi_evaluations_ += foot.iterations;
      if (!foot.converged) continue;
      next = foot.point;
    }
    mesh_.V[mid_side] = next;
    if (energy(mid_side) < kProgress * E) return true;
  }
  mesh_.V[mid_side] = start;
  return false;
}

std::vector<int> MidSideRelaxation::mid_sides_of(const std::vector<int>& tets) {
  std::vector<int> all;
  for (const int t : tets) {
    all.insert(all.end(), mesh_.C[t].begin() + 4, mesh_.C[t].end());
    has_met_rim_ |= at_rim_ && (*at_rim_)[t];
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

std::vector<int> MidSideRelaxation::tets_below_at(const std::vector<int>& mid_sides, double bar) const {
  std::vector<int> tets;
  for (const int m : mid_sides) tets.insert(tets.end(), tets_at(m).begin(), tets_at(m).end());
  std::sort(tets.begin(), tets.end());
  tets.erase(std::unique(tets.begin(), tets.end()), tets.end());
  std::erase_if(tets, [&](int t) { return jacobian_bounds(nodes_of(mesh_, mesh_.C[t])).scaled_lower() > bar; });
  return tets;
}

std::size_t MidSideRelaxation::relax(std::vector<int>& below, const Context& context) {
  n_psi_evaluations_ = 0;
  for (int sweep = 0; sweep < params_.sweeps && !below.empty(); ++sweep) {
    context.poll();
    const std::vector<int> around = mid_sides_of(below);
    bool moved = false;
    for (const int m : around) moved |= kind_[m - n_corners_] != MidSide::Fixed && improve(m);
    below = tets_below_at(around, params_.target);
    if (!moved) break;
  }
  return n_psi_evaluations_;
}

void MidSideRelaxation::retreat(const std::vector<int>& below) {
  std::map<int, int> halvings;
  std::vector<int> bad = tets_below_at(mid_sides_of(below), params_.least);
  while (!bad.empty()) {
    std::vector<int> moved;
    for (const int m : mid_sides_of(bad)) {
      const Vec3 middle = chord_middle(m);
      if (mesh_.V[m] == middle) continue;
      mesh_.V[m] = ++halvings[m] > kHalvings ? middle : Vec3((mesh_.V[m] + middle) / 2);
      if (MidSide& kind = kind_[m - n_corners_]; kind == MidSide::Surface) kind = MidSide::Fixed;
      moved.push_back(m);
    }
    bad = tets_below_at(moved, params_.least);
  }
}

}  // namespace umtet
