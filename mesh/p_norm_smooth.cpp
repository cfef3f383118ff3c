#include "mesh/p_norm_smooth.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <atomic>
#include <bitset>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>

#include "mesh/tet_quality.h"

namespace umtet {
namespace {

using Lane = Eigen::Array<double, kLanes, 1>;
using LaneMap = Eigen::Map<const Lane, Eigen::Aligned32>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// log2 of the powers of F, in turn. 16 and 32 with a least gain of 3e-4 end within .005 of the min Q of 4, 16, 64 with
// 1e-4, in half of the time (sphere, torus, eq. (9), T4, T6, ellipsoid 1:1:.1, 100k tets each); 16 alone loses .004
// more.
constexpr int kFirstPower = 4, kLastPower = 5;
constexpr double kNorm = 3 << kLastPower;  // the p of 1/Q that goes with the last
constexpr double kStepCap = .5;            // of h: beyond, a vertex leaves the star it had
constexpr double kVolumeKept = .2;         // of every V, in one step: Newton's picture of 1 / V^2 holds no farther
constexpr int kHalvings = 4;               // of a step that does not lower its sum; the queue comes back
constexpr int kSlides = 3;                 // lengths of a tangential step that are tried on the surface
constexpr int kUntangleRounds = 8;         // values of sigma; the queue comes back for those that rise
constexpr double kVolumeScale = .07;       // of h^3: a tenth of six times the volume of a background tet
// A visit takes about a microsecond, handing a task to a thread a few.
constexpr std::size_t kVisitsPerTask = 32;
constexpr std::size_t kWorthThreads = 64;
constexpr std::size_t kVisitsPerPoll = 1 << 12;
constexpr std::size_t kTetsPerTask = 1 << 12;  // some ten nanoseconds each

LaneMap lane(const std::array<double, kMaxRing>& a, int k) { return LaneMap(a.data() + k); }

template <int log2_p>
Lane to_power(Lane x) {
  for (int j = 0; j < log2_p; ++j) x *= x;
  return x;
}

Lane volumes(const OneRing& r, int k, const Vec3& y) {
  return lane(r.v, k) - (lane(r.nx, k) * y.x() + lane(r.ny, k) * y.y() + lane(r.nz, k) * y.z());
}

/// Fills up the last lanes with tets of F = 0 in place of copies, which would count twice in a sum.
void silence_padding(OneRing& r) {
  for (int j = r.n; j % kLanes != 0; ++j) r.v[j] = kInfinity, r.nx[j] = r.ny[j] = r.nz[j] = 0;
}

double least_volume(const OneRing& r, const Vec3& y) {
  Lane least = Lane::Constant(kInfinity);
  for (int k = 0; k < r.n; k += kLanes) least = least.min(volumes(r, k, y));
  return least.minCoeff();
}

/// Without the factor 1 / 432 of F: scales take it out again.
struct Sum {
  double sum, max_F;  ///< infinite where some V <= 0
};
template <int log2_p>
Sum sum_of_powers(const OneRing& r, const Vec3& y, double scale) {
  const double y2 = 3 * y.squaredNorm(), inverse = 1 / scale;
  Lane sum = Lane::Zero(), greatest = Lane::Zero(), least_V = Lane::Constant(kInfinity);
  for (int k = 0; k < r.n; k += kLanes) {
    const Lane V = volumes(r, k, y);
    const Lane L = lane(r.l, k) + (lane(r.sx, k) * y.x() + lane(r.sy, k) * y.y() + lane(r.sz, k) * y.z()) + y2;
    const Lane F = L * L * L / (V * V);
    least_V = least_V.min(V);
    greatest = greatest.max(F);
    sum += to_power<log2_p>(F * inverse);
  }
  if (!(least_V.minCoeff() > 0)) return {kInfinity, kInfinity};
  return {sum.sum(), greatest.maxCoeff()};
}

template <int log2_p>
PowerSum power_sum_of(const OneRing& r, const Vec3& y, double scale) {
  const double y2 = 3 * y.squaredNorm(), inverse = 1 / scale, p = 1 << log2_p;
  Lane sum = Lane::Zero(), least_V = Lane::Constant(kInfinity), diagonal = Lane::Zero();
  std::array<Lane, 3> G = {Lane::Zero(), Lane::Zero(), Lane::Zero()};
  std::array<Lane, 6> M = {Lane::Zero(), Lane::Zero(), Lane::Zero(), Lane::Zero(), Lane::Zero(), Lane::Zero()};
  for (int k = 0; k < r.n; k += kLanes) {
    const Lane Nx = lane(r.nx, k), Ny = lane(r.ny, k), Nz = lane(r.nz, k);
    const Lane Sx = lane(r.sx, k), Sy = lane(r.sy, k), Sz = lane(r.sz, k);
    const Lane V = lane(r.v, k) - (Nx * y.x() + Ny * y.y() + Nz * y.z());
    const Lane L = lane(r.l, k) + (Sx * y.x() + Sy * y.y() + Sz * y.z()) + y2;
    least_V = least_V.min(V);
    const Lane iV = 1 / V, iL = 1 / L;
    const Lane w = to_power<log2_p>(L * L * L * iV * iV * inverse);
    // b = -grad V / V, a = grad L / L, and g = grad ln F = 3 a + 2 b. Hess ln F = 18 / L I - 3 a a^T + 2 b b^T.
    const Lane bx = Nx * iV, by = Ny * iV, bz = Nz * iV;
    const Lane ax = (Sx + 6 * y.x()) * iL, ay = (Sy + 6 * y.y()) * iL, az = (Sz + 6 * y.z()) * iL;
    const Lane gx = 3 * ax + 2 * bx, gy = 3 * ay + 2 * by, gz = 3 * az + 2 * bz;
    sum += w;
    diagonal += w * iL;
    G[0] += w * gx, G[1] += w * gy, G[2] += w * gz;
    const Lane pw = p * w, a3 = 3 * w, b2 = 2 * w;
    M[0] += pw * gx * gx - a3 * ax * ax + b2 * bx * bx;
    M[1] += pw * gy * gy - a3 * ay * ay + b2 * by * by;
    M[2] += pw * gz * gz - a3 * az * az + b2 * bz * bz;
    M[3] += pw * gx * gy - a3 * ax * ay + b2 * bx * by;
    M[4] += pw * gx * gz - a3 * ax * az + b2 * bx * bz;
    M[5] += pw * gy * gz - a3 * ay * az + b2 * by * bz;
  }
  PowerSum result;
  if (!(least_V.minCoeff() > 0)) {
    result.sum = kInfinity;
    return result;
  }
  result.sum = sum.sum();
  const double one = 1 / result.sum, d = 18 * diagonal.sum() * one;
  result.gradient = Vec3(G[0].sum(), G[1].sum(), G[2].sum()) * one;
  const double xy = M[3].sum() * one, xz = M[4].sum() * one, yz = M[5].sum() * one;
  result.hessian << M[0].sum() * one + d, xy, xz, xy, M[1].sum() * one + d, yz, xz, yz, M[2].sum() * one + d;
  result.hessian -= p * result.gradient * result.gradient.transpose();
  return result;
}

/// H x = b for a symmetric H > 0 by cofactors; zero where it is not.
Vec3 solve(const Mat3& H, const Vec3& b) {
  const Vec3 c0 = H.col(1).cross(H.col(2)), c1 = H.col(2).cross(H.col(0)), c2 = H.col(0).cross(H.col(1));
  const double det = H.col(0).dot(c0);
  if (!(det > 0)) return Vec3::Zero();
  return (c0 * b.x() + c1 * b.y() + c2 * b.z()) / det;
}

/// Where a vertex may step: everywhere, or along a plane.
struct Directions {
  bool plane = false;
  Eigen::Matrix<double, 3, 2> tangents;

  Vec3 newton_step(const PowerSum& at) const {
    // The p-norm of 1/Q is exp(ln(sum) / 3 p): its Newton step goes with this matrix. That of the sum itself would
    // shrink like 1 / p far from the optimum, where one tet rules.
    const Mat3 H = at.hessian + at.gradient * at.gradient.transpose() / 3;
    if (!plane) return -solve(H, at.gradient);
    const Eigen::Matrix2d H2 = tangents.transpose() * H * tangents;
    if (!(H2.determinant() > 0)) return Vec3::Zero();
    return -(tangents * (H2.inverse() * (tangents.transpose() * at.gradient)));
  }
};

/// The greatest part of a step, at most all of it, that leaves every V the share kVolumeKept.
double volume_limit(const OneRing& r, const Vec3& y, const Vec3& step) {
  Lane shrink = Lane::Zero();
  for (int k = 0; k < r.n; k += kLanes) {
    const Lane rate = lane(r.nx, k) * step.x() + lane(r.ny, k) * step.y() + lane(r.nz, k) * step.z();
    shrink = shrink.max(rate / volumes(r, k, y));
  }
  return std::min(1., (1 - kVolumeKept) / shrink.maxCoeff());
}

/// A Newton step from y for one power, if there is one that lowers the sum.
template <int log2_p>
void newton_step(const OneRing& ring, double h, const Directions& directions, Vec3& y, double& max_F) {
  const double scale = max_F;
  const PowerSum at = power_sum_of<log2_p>(ring, y, scale);
  Vec3 step = directions.newton_step(at);
  const double length = step.norm();
  if (!(length > 0) || !std::isfinite(length)) return;
  if (length > kStepCap * h) step *= kStepCap * h / length;
  step *= volume_limit(ring, y, step);
  for (int halving = 0; halving <= kHalvings; ++halving, step *= .5) {
    const Sum there = sum_of_powers<log2_p>(ring, y + step, scale);
    if (!(there.sum < at.sum)) continue;
    y += step;
    max_F = there.max_F;
    return;
  }
}

/// From y, a Newton step for each power. Returns where they end. \pre every V > 0 at y
Vec3 newton(const OneRing& ring, Vec3 y, double h, const Directions& directions, double max_F) {
  newton_step<kFirstPower>(ring, h, directions, y, max_F);
  newton_step<kLastPower>(ring, h, directions, y, max_F);
  return y;
}

/// From y, moves until every V > 0 or min V rises no more.
Vec3 untangle(const OneRing& ring, Vec3 y, double h, const Directions& directions) {
  const double unit = kVolumeScale * h * h * h;
  OneRing shifted = ring;
  for (int round = 0; round < kUntangleRounds; ++round) {
    const double least = least_volume(ring, y);
    if (least > 0) break;
    const double sigma = unit - least;
    for (int j = 0; j < ring.n; ++j) shifted.v[j] = ring.v[j] + sigma;
    const Vec3 next = newton(shifted, y, h, directions, sum_of_powers<0>(shifted, y, 1).max_F);
    if (!(least_volume(ring, next) > least)) break;
    y = next;
  }
  return y;
}

/// What a place has to be better than: the ring at y = 0.
struct Bar {
  double scale, sum = kInfinity;  ///< of F, and of (F / scale)^p for the last p, where all V > 0
  double least_volume = 0;        ///< min V where it is not
  double least_gain = 0;          ///< relative, of the norm or of min V in units of a background tet's

  /// @param min_f  of the ring at 0
  Bar(const OneRing& ring, double min_f, double h, double gain) : scale(1 / min_f) {
    if (min_f > 0) {
      sum = sum_of_powers<kLastPower>(ring, Vec3::Zero(), scale).sum;
      least_gain = kNorm * gain;
    } else {
      least_volume = umtet::least_volume(ring, Vec3::Zero());
      least_gain = kVolumeScale * h * h * h * gain;
    }
  }
  bool tangled() const { return sum == kInfinity; }
  bool passed(const OneRing& ring, const Vec3& y) const {
    if (tangled()) return umtet::least_volume(ring, y) > least_volume + least_gain;
    return sum_of_powers<kLastPower>(ring, y, scale).sum < sum * (1 - least_gain);
  }
};

/// The best displacement of a vertex that may step in these directions; as good as the ring can be had in one visit.
Vec3 best_displacement(const OneRing& ring, const Bar& bar, double h, const Directions& directions) {
  if (!bar.tangled()) return newton(ring, Vec3::Zero(), h, directions, bar.scale);
  const Vec3 y = untangle(ring, Vec3::Zero(), h, directions);
  const double max_F = sum_of_powers<0>(ring, y, 1).max_F;
  return std::isfinite(max_F) ? newton(ring, y, h, directions, max_F) : y;
}

/// One visit. Reads the ring, changes nothing.
class Visitor {
 public:
  Visitor(const PNormSmoother& smoother, ImplicitFunctionRef psi, const SmoothParams& params)
      : smoother_(smoother),
        shell_(smoother.shell()),
        psi_(psi),
        closest_point_(params.closest_point),
        good_f_(f_of_quality(params.target + params.margin)),
        least_gain_(params.least_gain) {}

  struct Result {
    bool needed = false, moved = false;
    Vec3 place;
    std::bitset<kMaxRing> poor;  ///< which tets of the ring are below target + margin, before or after the move
    std::size_t psi_evaluations = 0;
  };

  Result operator()(int i) const {
    Result result;
    OneRing ring = smoother_.ring(i);
    const double min_f = ring.min_f(Vec3::Zero());
    if (min_f >= good_f_) return result;
    result.needed = true;
    silence_padding(ring);
    const Bar bar(ring, min_f, shell_.h, least_gain_);
    if (shell_.role[i] == Shell::Role::Inner) {
      const Vec3 y = best_displacement(ring, bar, shell_.h, {});
      result.moved = bar.passed(ring, y);
      result.place = shell_.V[i] + y;
    } else {
      slide(ring, bar, shell_.V[i], result);
    }
    if (result.moved) mark_poor(ring, result.place - shell_.V[i], result.poor);
    return result;
  }

 private:
  static double f_of_quality(double Q) {
    const double root = Q / kMeanRatioFactor;
    return root * root * root;
  }

  void mark_poor(const OneRing& ring, const Vec3& y, std::bitset<kMaxRing>& poor) const {
    const double y2 = 3 * y.squaredNorm();
    for (int k = 0; k < ring.n; k += kLanes) {
      const Lane V0 = lane(ring.v, k), V1 = volumes(ring, k, y), L0 = lane(ring.l, k);
      const Lane L1 = L0 + (lane(ring.sx, k) * y.x() + lane(ring.sy, k) * y.y() + lane(ring.sz, k) * y.z()) + y2;
      const Lane f = (V0 * V0.abs() / (L0 * L0 * L0)).min(V1 * V1.abs() / (L1 * L1 * L1));
      for (int m = 0; m < kLanes; ++m) poor[k + m] = f[m] < good_f_;
    }
  }

  /// Along the tangent plane, and back to the surface.
  void slide(const OneRing& ring, const Bar& bar, const Vec3& x, Result& result) const {
    Vec3 gradient;
    psi_.value(x, gradient);
    ++result.psi_evaluations;
    const double norm = gradient.norm();
    if (!(norm > 0) || !std::isfinite(norm)) return;
    Directions tangent{true, {}};
    tangent.tangents.col(0) = gradient.unitOrthogonal();
    tangent.tangents.col(1) = (gradient / norm).cross(tangent.tangents.col(0));
    Vec3 y = best_displacement(ring, bar, shell_.h, tangent);
    for (int trial = 0; trial < kSlides && bar.passed(ring, y); ++trial, y *= .5) {
      const ClosestPoint foot = closest_point(psi_, x + y, shell_.h, closest_point_);
      result.psi_evaluations += static_cast<std::size_t>(foot.iterations);
      if (!foot.converged || !bar.passed(ring, foot.point - x)) continue;
      result.moved = true;
      result.place = foot.point;
      return;
    }
  }

  const PNormSmoother& smoother_;
  const Shell& shell_;
  ImplicitFunctionRef psi_;
  const ClosestPointParams& closest_point_;
  double good_f_, least_gain_;
};

struct Counts {
  std::size_t looks = 0, visits = 0, moves = 0, psi_evaluations = 0;
  Counts operator+(const Counts& o) const {
    return {looks + o.looks, visits + o.visits, moves + o.moves, psi_evaluations + o.psi_evaluations};
  }
};

bool is_fixed(const Shell& shell, int i) { return shell.role[i] == Shell::Role::Fixed; }

/// The state part of a report.
void measure(const Shell& shell, SmoothReport& report) {
  const double min_f = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, shell.C.size(), kTetsPerTask), kInfinity,
      [&](const auto& range, double least) {
        for (std::size_t k = range.begin(); k != range.end(); ++k) {
          const Tet& t = shell.C[k];
          if (std::all_of(t.begin(), t.end(), [&](int i) { return is_fixed(shell, i); })) continue;
          const Vec3 &a = shell.V[t[0]], &b = shell.V[t[1]], &c = shell.V[t[2]], &d = shell.V[t[3]];
          const double V = volume6(a, b, c, d), L = sum_of_squared_edges(a, b, c, d);
          least = std::min(least, V * std::abs(V) / (L * L * L));
        }
        return least;
      },
      [](double x, double y) { return std::min(x, y); });
  report.min_quality = std::min(1., quality_of(min_f));
  report.tangled = 0;
  if (min_f > 0) return;
  std::vector<bool> tangled(shell.V.size(), false);
  for (const Tet& t : shell.C) {
    if (volume6(shell.V[t[0]], shell.V[t[1]], shell.V[t[2]], shell.V[t[3]]) > 0) continue;
    for (const int i : t) {
      if (!is_fixed(shell, i) && !tangled[i]) tangled[i] = true, ++report.tangled;
    }
  }
}

}  // namespace

PowerSum power_sum(const OneRing& ring, const Vec3& y, int log2_p, double scale) {
  OneRing silenced = ring;
  silence_padding(silenced);
  scale *= kMeanRatioFactor * kMeanRatioFactor * kMeanRatioFactor;
  if (log2_p == kFirstPower) return power_sum_of<kFirstPower>(silenced, y, scale);
  if (log2_p == kLastPower) return power_sum_of<kLastPower>(silenced, y, scale);
  throw std::invalid_argument("power_sum: log2_p = " + std::to_string(log2_p) + ": must be 4 or 5");
}

std::vector<std::string> problems(const SmoothParams& params) {
  std::vector<std::string> list = problems(params.closest_point);
  for (std::string& problem : list) problem = "closest_point." + problem;
  const auto refuse = [&](const char* name, double value, const char* rule) {
    list.push_back(std::string(name).append(" = ").append(std::to_string(value)).append(": must be ").append(rule));
  };
  if (!(params.target > 0 && params.target < 1)) refuse("target", params.target, "> 0 and < 1");
  if (!(params.margin >= 0)) refuse("margin", params.margin, ">= 0");
  if (!(params.least_gain > 0 && params.least_gain < 1 / kNorm))
    refuse("least_gain", params.least_gain, "> 0 and < 1 / 96");
  if (params.max_sweeps < 0) refuse("max_sweeps", params.max_sweeps, ">= 0");
  return list;
}

SmoothReport& SmoothReport::operator+=(const SmoothReport& later) {
  sweeps += later.sweeps;
  looks += later.looks;
  visits += later.visits;
  moves += later.moves;
  psi_evaluations += later.psi_evaluations;
  tangled = later.tangled;
  min_quality = later.min_quality;
  settled = later.settled;
  return *this;
}

PNormSmoother::PNormSmoother(Shell& shell) : shell_(shell), faces_(shell.ring.size()), queued_(shell.V.size(), 0) {
  std::vector<std::size_t> count;
  for (std::size_t i = 0; i < shell.V.size(); ++i) {
    if (is_fixed(shell, static_cast<int>(i))) continue;
    const int n = shell.ring_begin[i + 1] - shell.ring_begin[i];
    if (n < 1 || n > kMaxRing) {
      throw std::invalid_argument("vertex " + std::to_string(i) + " has " + std::to_string(n) + " tets: must be 1 to " +
                                  std::to_string(kMaxRing));
    }
    queued_[i] = 1;
    const auto colour = static_cast<std::size_t>(shell.colour[i]);
    if (colour >= count.size()) count.resize(colour + 1, 0);
    ++count[colour];
  }
  colour_begin_.assign(1, 0);
  for (const std::size_t n : count) colour_begin_.push_back(colour_begin_.back() + n);
  by_colour_.resize(colour_begin_.back());
  std::vector<std::size_t> next(colour_begin_.begin(), colour_begin_.end() - 1);
  for (std::size_t i = 0; i < shell.V.size(); ++i) {
    if (queued_[i] != 0) by_colour_[next[shell.colour[i]]++] = static_cast<int>(i);
  }
  if (!count.empty()) todo_.reserve(*std::max_element(count.begin(), count.end()));
  const auto list_faces = [&](const tbb::blocked_range<std::size_t>& range) {
    for (std::size_t k = range.begin(); k != range.end(); ++k) {
      const int i = by_colour_[k];
      for (int r = shell.ring_begin[i]; r < shell.ring_begin[i + 1]; ++r) {
        const Tet& t = shell.C[shell.ring[r]];
        const auto own = std::find(t.begin(), t.end(), i) - t.begin();
        faces_[r] = {t[kTetFace[own][0]], t[kTetFace[own][1]], t[kTetFace[own][2]]};
      }
    }
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, by_colour_.size(), kTetsPerTask / 16), list_faces);
}

void PNormSmoother::wake_all() {
  for (const int i : by_colour_) queued_[i] = 1;
}

void PNormSmoother::wake_tet(int t) {
  // Vertices that share no tet may share a neighbour: both then write the same one, so relaxed stores will do.
  for (const int j : shell_.C[t]) std::atomic_ref(queued_[j]).store(1, std::memory_order_relaxed);
}

void PNormSmoother::wake(int i) {
  for (int r = shell_.ring_begin[i]; r < shell_.ring_begin[i + 1]; ++r) wake_tet(shell_.ring[r]);
}

SmoothReport PNormSmoother::run(ImplicitFunctionRef psi, const SmoothParams& params, const KeepGoing& keep_going) {
  if (const auto list = problems(params); !list.empty()) {
    std::string all;
    for (const std::string& problem : list) all += (all.empty() ? "" : "; ") + problem;
    throw std::invalid_argument(all);
  }
  const Visitor visit(*this, psi, params);
  const auto visit_some = [&](const tbb::blocked_range<std::size_t>& range, Counts counts) {
    for (std::size_t k = range.begin(); k != range.end(); ++k) {
      const int i = todo_[k];
      const Visitor::Result result = visit(i);
      ++counts.looks;
      counts.visits += result.needed;
      counts.moves += result.moved;
      counts.psi_evaluations += result.psi_evaluations;
      if (!result.moved) continue;
      shell_.V[i] = result.place;
      // A tet that was good and is good again keeps nobody from being where it is.
      for (int r = shell_.ring_begin[i], j = 0; r < shell_.ring_begin[i + 1]; ++r, ++j) {
        if (result.poor[j]) wake_tet(shell_.ring[r]);
      }
    }
    return counts;
  };
  SmoothReport report;
  while (report.sweeps < params.max_sweeps && !report.settled) {
    Counts sweep;
    for (std::size_t c = 0; c + 1 < colour_begin_.size(); ++c) {
      todo_.clear();
      for (std::size_t k = colour_begin_[c]; k < colour_begin_[c + 1]; ++k) {
        const int i = by_colour_[k];
        if (queued_[i] == 0 || is_fixed(shell_, i)) continue;
        queued_[i] = 0;
        todo_.push_back(i);
      }
      for (std::size_t begin = 0; begin < todo_.size(); begin += kVisitsPerPoll) {
        poll(keep_going);
        const tbb::blocked_range<std::size_t> some(begin, std::min(todo_.size(), begin + kVisitsPerPoll),
                                                   kVisitsPerTask);
        sweep = sweep + (some.size() < kWorthThreads ? visit_some(some, Counts{})
                                                     : tbb::parallel_reduce(some, Counts{}, visit_some, std::plus<>()));
      }
    }
    ++report.sweeps;
    report.looks += sweep.looks;
    report.visits += sweep.visits;
    report.moves += sweep.moves;
    report.psi_evaluations += sweep.psi_evaluations;
    report.settled = sweep.moves == 0;
  }
  measure(shell_, report);
  return report;
}

SmoothReport smooth(Shell& shell, ImplicitFunctionRef psi, const SmoothParams& params, const KeepGoing& keep_going) {
  return PNormSmoother(shell).run(psi, params, keep_going);
}

}  // namespace umtet
