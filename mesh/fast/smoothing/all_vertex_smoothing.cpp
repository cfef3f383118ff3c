#include "mesh/fast/smoothing/all_vertex_smoothing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "mesh/core/tet_quality.h"
#include "mesh/fast/smoothing/detail/lbfgs_direction.h"

namespace umtet {
namespace {

using Eigen::VectorXd;
using Role = ActiveLayer::Role;

constexpr double kInfinity = std::numeric_limits<double>::infinity();  // phi of what is no mesh

// p = 3 * 2^5, 3 * 2^7, 3 * 2^9: F = Q^-3 takes no roots, and its powers are repeated squares. The first is what
// PNormSmoother leaves; the last is within (ln 100) / 1536 = .3 % of the least of a hundred equal tets.
constexpr int kLog2Powers[] = {5, 7, 9};
constexpr int kMostSteps = 60;  // for each p: patches of repair settle in 20 to 40
// Longest move of a vertex along an axis in a step, in edges: farther off, the pairs of L-BFGS say nothing. And of the
// first step, whose length no pair suggests.
constexpr double kLongestMove = .2, kFirstMove = .02;
// Of the decrease that the slope promises, what a step has to bring [NocedalWright2006, Section 3.1], and how often it
// is halved for that.
constexpr double kArmijo = 1e-4;
constexpr int kMostHalvings = 12;
// The last step of Newton's method to psi = 0, in edges: what is left after it is as its square. One or two evaluations
// are needed for that.
constexpr double kLastLanding = 1e-5;
constexpr int kMostLandings = 12;
// The least cosine of grad psi with the line: on a surface that is turned away farther the plane is no chart.
constexpr double kLeastSlope = .5;
// A tet with a smaller share of the sum has no part in the gradient.
constexpr double kLeastShare = 1e-12;

/// phi_p of the tets of a layer that have a vertex which moves. Unknowns: for each such vertex three, the displacement
/// from where it was at begin_here(), in edges; of a Boundary vertex the part in its tangent plane counts.
class LayerNorm {
 public:
  LayerNorm(ActiveLayer& layer, ImplicitFunctionRef psi) : layer_(layer), psi_(psi), unknown_(layer.V.size(), -1) {
    for (std::size_t v = 0; v < layer.V.size(); ++v) {
      if (layer.role[v] == Role::Fixed) continue;
      unknown_[v] = static_cast<int>(free_.size());
      free_.push_back({.vertex = static_cast<int>(v)});
      edge_ = std::max(edge_, layer.h_at(static_cast<int>(v)));
    }
    for (const Tet& t : layer.C) {
      if (std::any_of(t.begin(), t.end(), [&](int v) { return unknown_[v] >= 0; })) tets_.push_back(t);
    }
    weight_.resize(tets_.size());
    slope_.resize(free_.size());
  }

  Eigen::Index n_unknowns() const { return 3 * static_cast<Eigen::Index>(free_.size()); }
  std::size_t n_tets() const { return tets_.size(); }
  double least() const { return least_; }  ///< mean ratio at the last finite value()
  std::size_t psi_evaluations() const { return psi_evaluations_; }

  void begin_here() {
    for (Free& f : free_) {
      f.from = layer_.V[f.vertex];
      if (layer_.role[f.vertex] != Role::Boundary) continue;
      ++psi_evaluations_;
      if (layer_.strata) {
        f.free = layer_.strata->directions(layer_.stratum[f.vertex], f.from);
        f.free_there = f.free;
        continue;
      }
      psi_.value(f.from, f.gradient);
      f.normal = f.gradient.normalized();
    }
  }

  /// Puts the vertices of the layer there. Infinite where a tet is not positive, or a Boundary vertex does not get to
  /// psi = 0.
  double value(const VectorXd& u, int log2_power) {
    for (std::size_t k = 0; k < free_.size(); ++k) {
      Free& f = free_[k];
      const Vec3 d = edge_ * u.segment<3>(3 * static_cast<Eigen::Index>(k));
      if (layer_.role[f.vertex] != Role::Boundary) {
        layer_.V[f.vertex] = f.from + d;
      } else if (layer_.strata) {
        if (!land_on_stratum(f, d)) return kInfinity;
      } else if (!land(f, f.from + d - d.dot(f.normal) * f.normal)) {
        return kInfinity;
      }
    }
    double most = 0;
    for (std::size_t t = 0; t < tets_.size(); ++t) {
      const auto& [a, b, c, d] = corners(tets_[t]);
      const double V = volume6(a, b, c, d), L = sum_of_squared_edges(a, b, c, d);
      if (!(V > 0)) return kInfinity;
      weight_[t] = L * L * L / (V * V);
      most = std::max(most, weight_[t]);
    }
    least_ = kMeanRatioFactor / std::cbrt(most);
    const double least_ratio = std::pow(kLeastShare, std::ldexp(1., -log2_power));
    double sum = 0;
    for (double& w : weight_) w = w < least_ratio * most ? 0 : w / most;
    for (int k = 0; k < log2_power; ++k) {
      for (double& w : weight_) w *= w;
    }
    for (const double w : weight_) sum += w;
    for (double& w : weight_) w /= sum;
    return (std::ldexp(std::log(sum), -log2_power) + std::log(most)) / 3;
  }

  /// Of the last value(), which was finite: d phi = -sum_K w_K dQ_K / Q_K, w_K = Q_K^-p / sum Q^-p.
  void gradient(VectorXd& g) {
    std::fill(slope_.begin(), slope_.end(), Vec3::Zero());
    for (std::size_t t = 0; t < tets_.size(); ++t) {
      if (weight_[t] > 0) add(tets_[t], weight_[t]);
    }
    for (std::size_t k = 0; k < free_.size(); ++k) {
      const Free& f = free_[k];
      Vec3 s = slope_[k];
      if (layer_.role[f.vertex] == Role::Boundary && layer_.strata) {
        s = on_stratum(f, s);
      } else if (layer_.role[f.vertex] == Role::Boundary) {
        // x = x_0 + T u + z(u) n and psi(x) = 0: dz/du = -T^T grad psi / (n . grad psi).
        s -= s.dot(f.normal) / f.gradient.dot(f.normal) * f.gradient;
        s -= s.dot(f.normal) * f.normal;
      }
      g.segment<3>(3 * static_cast<Eigen::Index>(k)) = edge_ * s;
    }
  }

 private:
  struct Free {
    int vertex;
    Vec3 from = Vec3::Zero(), normal = Vec3::Zero();
    Vec3 gradient = Vec3::Zero();               ///< of psi, where the vertex is
    FreeDirections free = {}, free_there = {};  ///< with strata: at `from`, and where the vertex is
  };
  struct Corners {
    const Vec3 &a, &b, &c, &d;
  };

  Corners corners(const Tet& t) const { return {layer_.V[t[0]], layer_.V[t[1]], layer_.V[t[2]], layer_.V[t[3]]}; }

  /// Newton's method on the line from `x` along the normal, from where the tangent plane of the last place meets it.
  bool land(Free& f, const Vec3& x) {
    Vec3& at = layer_.V[f.vertex];
    double height = (at - x).dot(f.gradient) / f.normal.dot(f.gradient);
    for (int k = 0; k < kMostLandings && std::abs(height) < edge_; ++k) {
      at = x + height * f.normal;
      const double value = psi_.value(at, f.gradient);
      ++psi_evaluations_;
      const double slope = f.gradient.dot(f.normal);
      if (!(slope > kLeastSlope * f.gradient.norm())) break;
      height -= value / slope;
      if (std::abs(value) > kLastLanding * edge_ * slope) continue;
      at = x + height * f.normal;
      return true;
    }
    at = f.from;
    f.gradient = f.normal;
    return false;
  }

  // Not inlined: the rounding of smooth boundaries would change with the code around it.

  /// The slope by u. x(u) stays on the stratum, and T^T (x(u) - x_0) = T^T u to first order, as the steps of foot() are
  /// normal: dx/du = S (T^T S)^-1 T^T for tangents S at x.
  [[gnu::noinline]] static Vec3 on_stratum(const Free& f, const Vec3& s) {
    if (f.free.n == 0) return Vec3::Zero();
    if (f.free.n == 1) {
      const Vec3 t = f.free.tangents.col(0), there = f.free_there.tangents.col(0);
      return s.dot(there) / t.dot(there) * t;
    }
    const Eigen::Matrix2d M = f.free_there.tangents.transpose() * f.free.tangents;
    const Eigen::Vector2d along = f.free_there.tangents.transpose() * s;
    return f.free.tangents * (M.inverse() * along);
  }

  /// The foot of the displaced place on the stratum, and the directions there.
  [[gnu::noinline]] bool land_on_stratum(Free& f, const Vec3& d) {
    const int stratum = layer_.stratum[f.vertex];
    if (f.free.n == 0) {
      layer_.V[f.vertex] = f.from;
      return true;
    }
    const auto T = f.free.tangents.leftCols(f.free.n);
    const Vec3 along = T * (T.transpose() * d);
    ++psi_evaluations_;
    const BallOnPatch* ball = layer_.ball.empty() ? nullptr : &layer_.ball[f.vertex];
    if (along.norm() > edge_) return false;
    if (!layer_.strata->foot(stratum, f.from + along, edge_, layer_.V[f.vertex], ball)) return false;
    f.free_there = layer_.strata->directions(stratum, layer_.V[f.vertex]);
    if (f.free_there.n != f.free.n) return false;
    const Eigen::Matrix2d M = f.free_there.tangents.transpose() * f.free.tangents;
    return f.free.n == 1 ? std::abs(M(0, 0)) > kLeastSlope : std::abs(M.determinant()) > kLeastSlope;
  }

  /// Q^3 is proportional to V^2 / L^3.
  void add(const Tet& t, double weight) {
    const auto& [a, b, c, d] = corners(t);
    const Vec3 e = b - a, f = c - a, g = d - a, sum = e + f + g;
    const Vec3 of_b = f.cross(g), of_c = g.cross(e), of_d = e.cross(f);
    const double by_V = weight * 2 / (3 * e.dot(of_b)), by_L = weight * 2 / sum_of_squared_edges(a, b, c, d);
    const auto put = [&](int v, const Vec3& dV, const Vec3& dL) {
      if (unknown_[v] >= 0) slope_[unknown_[v]] += by_L * dL - by_V * dV;
    };
    put(t[0], -(of_b + of_c + of_d), -sum);
    put(t[1], of_b, 4 * e - sum);
    put(t[2], of_c, 4 * f - sum);
    put(t[3], of_d, 4 * g - sum);
  }

  ActiveLayer& layer_;
  ImplicitFunctionRef psi_;
  std::vector<int> unknown_;  ///< per vertex of the layer: its place in free_, or -1
  std::vector<Free> free_;
  std::vector<Tet> tets_;
  std::vector<double> weight_;  ///< per tet
  std::vector<Vec3> slope_;     ///< per free vertex
  double edge_ = 0, least_ = 0;
  std::size_t psi_evaluations_ = 0;
};

/// The places with the greatest least Q so far.
struct Best {
  double least;
  std::vector<Vec3> places;

  void meet(double least_there, const ActiveLayer& layer) {
    if (least_there <= least) return;
    least = least_there;
    places = layer.V;
  }
};

/// Steps of L-BFGS until they gain little, or reach the goal.
/// @return phi_p at the end, up to ln kMeanRatioFactor; -infinity where it falls on, +infinity if it was never finite
double minimise(LayerNorm& norm, int log2_power, double goal, double least_gain, const ActiveLayer& layer, Best& best,
                int& evaluations) {
  norm.begin_here();
  VectorXd u = VectorXd::Zero(norm.n_unknowns()), g(u.size()), next_u(u.size()), next_g(u.size()), step(u.size());
  detail::LbfgsDirection direction(u.size());
  double phi = norm.value(u, log2_power);
  ++evaluations;
  if (phi == kInfinity) return phi;
  best.meet(norm.least(), layer);
  norm.gradient(g);
  for (int k = 0; k < kMostSteps; ++k) {
    direction.find(g, step);
    const double longest = step.cwiseAbs().maxCoeff();
    if (direction.is_steepest()) {
      step *= kFirstMove / longest;
    } else if (longest > kLongestMove) {
      step *= kLongestMove / longest;
    }
    const double slope = step.dot(g);
    if (!(slope < 0)) return phi;
    double next = kInfinity, share = 1;
    for (int halving = 0; halving <= kMostHalvings; ++halving, share /= 2) {
      next_u = u + share * step;
      next = norm.value(next_u, log2_power);
      ++evaluations;
      if (next <= phi + kArmijo * share * slope) break;
    }
    if (!(next < phi)) {
      norm.value(u, log2_power);  // puts the vertices back
      return phi;
    }
    norm.gradient(next_g);
    direction.add(next_u - u, next_g - g);
    u.swap(next_u);
    g.swap(next_g);
    best.meet(norm.least(), layer);
    if (best.least >= goal || phi - next < least_gain) return next;
    phi = next;
  }
  return -kInfinity;  // not at a minimum yet
}

}  // namespace

AllVertexReport smooth_all_vertices(ActiveLayer& layer, ImplicitFunctionRef psi, double goal, double needed,
                                    double least_gain) {
  AllVertexReport report;
  LayerNorm norm(layer, psi);
  if (norm.n_tets() == 0) return report;
  Best best{0, layer.V};
  for (const int log2_power : kLog2Powers) {
    if (best.least >= goal) break;
    const double phi = minimise(norm, log2_power, goal, least_gain, layer, best, report.evaluations);
    const double spread = std::log(static_cast<double>(norm.n_tets())) / std::ldexp(3., log2_power);
    if (phi < kInfinity && kMeanRatioFactor * std::exp(spread - phi) < needed) break;
  }
  layer.V = std::move(best.places);
  report.least = best.least;
  report.psi_evaluations = norm.psi_evaluations();
  return report;
}

}  // namespace umtet
