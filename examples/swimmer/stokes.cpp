#include "examples/swimmer/stokes.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <stdexcept>

namespace umtet {
namespace {

/// A tet with its four affine functions.
struct Element {
  Eigen::Matrix<double, 4, 3> G;  ///< gradients, by row
  double volume;
  double h2;  ///< mean of the squared edges
};

Element element(std::span<const Vec3> V, const Tet& K) {
  Eigen::Matrix3d J;
  for (int c = 0; c < 3; ++c) J.col(c) = V[std::size_t(K[std::size_t(c) + 1])] - V[std::size_t(K[0])];
  Element e;
  e.volume = J.determinant() / 6;
  e.G.bottomRows<3>() = J.inverse();
  e.G.row(0) = -e.G.bottomRows<3>().colwise().sum();
  e.h2 = 0;
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t b = 0; b < a; ++b) e.h2 += (V[std::size_t(K[a])] - V[std::size_t(K[b])]).squaredNorm() / 6;
  }
  return e;
}

/// Rows of (v, q) at vertex a, columns of (u, p) at vertex b.
Eigen::Matrix4d element_block(const Element& e, int a, int b, double mu, double delta) {
  const Vec3 Ga = e.G.row(a), Gb = e.G.row(b);
  Eigen::Matrix4d K;
  K.topLeftCorner<3, 3>() = mu * e.volume * (Ga.dot(Gb) * Eigen::Matrix3d::Identity() + Gb * Ga.transpose());
  K.topRightCorner<3, 1>() = -e.volume / 4 * Ga;
  K.bottomLeftCorner<1, 3>() = -e.volume / 4 * Gb.transpose();
  K(3, 3) = -delta * e.volume * Ga.dot(Gb);
  return K;
}

StokesParams checked(const StokesParams& params, int n_vertices, std::span<const Tet> background) {
  if (const auto broken = problems(params); !broken.empty()) throw std::invalid_argument(broken.front());
  for (const Tet& K : background) {
    for (const int i : K) {
      if (i < 0 || i >= n_vertices) throw std::invalid_argument(fmt::format("vertex {}: there are {}", i, n_vertices));
    }
  }
  return params;
}

}  // namespace

std::vector<std::string> problems(const StokesParams& p) {
  std::vector<std::string> all;
  if (!(p.viscosity > 0)) all.push_back(fmt::format("viscosity = {}: must be > 0", p.viscosity));
  if (!(p.stabilisation > 0)) all.push_back(fmt::format("stabilisation = {}: must be > 0", p.stabilisation));
  if (!(p.tolerance > 0 && p.tolerance < 1))
    all.push_back(fmt::format("tolerance = {}: must be in (0, 1)", p.tolerance));
  if (p.max_iterations < 1) all.push_back(fmt::format("max_iterations = {}: must be >= 1", p.max_iterations));
  return all;
}

StokesSolver::StokesSolver(int n_vertices, std::span<const Tet> background, const StokesParams& params)
    : params_(checked(params, n_vertices, background)),
      background_(background),
      system_(n_vertices, background),
      fixed_(std::size_t(n_vertices)) {}

void StokesSolver::assemble(std::span<const Vec3> V, std::span<const int> fluid, std::span<const int> fixed) {
  if (V.size() != fixed_.size()) {
    throw std::invalid_argument(fmt::format("{} vertices, the background has {}", V.size(), fixed_.size()));
  }
  V_.assign(V.begin(), V.end());
  fluid_.assign(fluid.begin(), fluid.end());
  std::fill(fixed_.begin(), fixed_.end(), char(0));
  for (const int i : fixed) fixed_[std::size_t(i)] = 1;

  const double mu = params_.viscosity;
  std::vector<Vec3> flux(V.size(), Vec3::Zero());  // int grad N_i: nonzero on the boundary only
  std::vector<double> flux_scale(V.size(), 0.);    // zero: not a vertex of the fluid
  share_.assign(V.size(), 0.);
  volume_ = 0;
  system_.clear();
  for (const int t : fluid_) {
    const Tet& K = background_[std::size_t(t)];
    const Element e = element(V_, K);
    if (!(e.volume > 0)) throw std::invalid_argument(fmt::format("tet {}: volume {} is not positive", t, e.volume));
    volume_ += e.volume;
    const double delta = params_.stabilisation * e.h2 / mu;
    for (int a = 0; a < 4; ++a) {
      const int i = K[std::size_t(a)];
      flux[std::size_t(i)] += e.volume * e.G.row(a).transpose();
      flux_scale[std::size_t(i)] += e.volume * e.G.row(a).norm();
      share_[std::size_t(i)] += e.volume / 4;
      system_.pressure_weight(i) += e.volume / 4 / mu + delta * e.volume * e.G.row(a).squaredNorm();
      for (int b = 0; b < 4; ++b) {
        const int j = K[std::size_t(b)];
        Eigen::Matrix4d block = element_block(e, a, b, mu, delta);
        if (fixed_[std::size_t(i)]) block.topRows<3>().setZero();
        if (fixed_[std::size_t(j)]) block.leftCols<3>().setZero();
        system_.block(i, j) += block;
        if (!fixed_[std::size_t(i)] && !fixed_[std::size_t(j)]) {
          system_.stiffness(i, j) += mu * e.volume * e.G.row(a).dot(e.G.row(b));
        }
      }
    }
  }

  // Values that are not unknowns get an identity row. A boundary with a free vertex determines the pressure.
  wet_.clear();
  enclosed_ = true;
  std::size_t n_fixed = 0;
  for (int i = 0; i < int(V.size()); ++i) {
    const std::size_t s = std::size_t(i);
    const bool wet = flux_scale[s] > 0;
    if (wet) wet_.push_back(i);
    if (wet && fixed_[s]) ++n_fixed;
    if (wet && !fixed_[s] && flux[s].norm() > 1e-9 * flux_scale[s]) enclosed_ = false;
    if (!wet || fixed_[s]) {
      system_.block(i, i).topLeftCorner<3, 3>().setIdentity();
      system_.stiffness(i, i) = 1;
    }
    if (!wet) system_.block(i, i)(3, 3) = system_.pressure_weight(i) = 1;
  }
  if (n_fixed < 3) throw std::invalid_argument(fmt::format("{} fixed vertices in the fluid: must be >= 3", n_fixed));
  system_.set_up();
}

std::vector<double> StokesSolver::residual(const StokesFlow& flow, std::span<const Vec3> f) const {
  std::vector<double> r(4 * fixed_.size(), 0.);
  for (const int t : fluid_) {
    const Tet& K = background_[std::size_t(t)];
    const Element e = element(V_, K);
    const double mu = params_.viscosity, delta = params_.stabilisation * e.h2 / mu;
    Eigen::Matrix3d grad_u = Eigen::Matrix3d::Zero();  // (i, j): d u_i / d x_j
    Vec3 grad_p = Vec3::Zero(), sum_f = Vec3::Zero();
    double mean_p = 0;
    for (int a = 0; a < 4; ++a) {
      const std::size_t i = std::size_t(K[std::size_t(a)]);
      grad_u += flow.u[i] * e.G.row(a);
      grad_p += flow.p[i] * e.G.row(a).transpose();
      mean_p += flow.p[i] / 4;
      if (!f.empty()) sum_f += f[i];
    }
    const Eigen::Matrix3d sigma = mu * (grad_u + grad_u.transpose()) - mean_p * Eigen::Matrix3d::Identity();
    for (int a = 0; a < 4; ++a) {
      const std::size_t i = std::size_t(K[std::size_t(a)]);
      Eigen::Map<Eigen::Vector4d> out(&r[4 * i]);
      const Vec3 Ga = e.G.row(a);
      out.head<3>() += e.volume * (sigma * Ga);
      out[3] -= e.volume * (grad_u.trace() / 4 + delta * Ga.dot(grad_p - sum_f / 4));
      if (!f.empty()) out.head<3>() -= e.volume / 20 * (sum_f + f[i]);
    }
  }
  return r;
}

StokesFlow StokesSolver::solve(std::span<const Vec3> velocity, std::span<const Vec3> f) {
  const std::size_t n = fixed_.size();
  if (velocity.size() != n)
    throw std::invalid_argument(fmt::format("{} velocities for {} vertices", velocity.size(), n));
  if (!f.empty() && f.size() != n) throw std::invalid_argument(fmt::format("{} forces for {} vertices", f.size(), n));
  if (wet_.empty()) throw std::invalid_argument("solve() before assemble()");

  // The unknowns are added to the given velocities.
  StokesFlow flow{std::vector<Vec3>(n, Vec3::Zero()), std::vector<double>(n, 0.), {}};
  for (const int i : wet_) {
    if (fixed_[std::size_t(i)]) flow.u[std::size_t(i)] = velocity[std::size_t(i)];
  }
  std::vector<double> b = residual(flow, f), x(4 * n, 0.);
  for (double& value : b) value = -value;
  double unbalanced = 0;
  for (const int i : wet_) {
    unbalanced += b[4 * std::size_t(i) + 3];
    if (fixed_[std::size_t(i)]) std::fill_n(&b[4 * std::size_t(i)], 3, 0.);
  }
  if (enclosed_) {
    for (const int i : wet_) b[4 * std::size_t(i) + 3] -= unbalanced * share_[std::size_t(i)] / volume_;
  }
  flow.krylov = system_.solve(b, x, params_.tolerance, params_.max_iterations);
  for (const int i : wet_) {
    const std::size_t s = std::size_t(i);
    if (!fixed_[s]) flow.u[s] = Eigen::Map<const Vec3>(&x[4 * s]);
    flow.p[s] = x[4 * s + 3];
  }
  if (enclosed_) {
    double integral = 0;
    for (const int i : wet_) integral += share_[std::size_t(i)] * flow.p[std::size_t(i)];
    for (const int i : wet_) flow.p[std::size_t(i)] -= integral / volume_;
  }
  return flow;
}

std::vector<Vec3> StokesSolver::forces(const StokesFlow& flow, std::span<const Vec3> f) const {
  const std::vector<double> r = residual(flow, f);
  std::vector<Vec3> all(fixed_.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = -Eigen::Map<const Vec3>(&r[4 * i]);
  return all;
}

}  // namespace umtet
