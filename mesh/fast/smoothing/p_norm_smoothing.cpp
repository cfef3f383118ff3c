#include "mesh/fast/smoothing/p_norm_smoothing.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <bitset>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "common/polled_loops.h"
#include "mesh/core/asking_psi.h"
#include "mesh/core/tet_quality.h"
#include "mesh/fast/smoothing/ring_newton.h"

namespace umtet {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kSlides = 3;  // lengths of a tangential step that are tried on the surface
// Over-relaxation: a step this many times Newton's is taken where it lowers the norm, too. As in successive
// over-relaxation of linear systems the vertices then settle in fewer solves; 1 means none. The values are not
// critical.
constexpr double kInnerFactor = 1.4, kBoundaryFactor = 2;
// A solve takes about a microsecond; to hand a task to a thread takes a few.
constexpr std::size_t kSolvesPerTask = 32;
constexpr std::size_t kWorthThreads = 256;
constexpr std::size_t kSolvesPerPoll = 1 << 12;
constexpr std::size_t kTetsPerTask = 1 << 12;  // some ten nanoseconds each

constexpr std::size_t kAhead = 2;  // solves: the ring of a vertex is prefetched before it is needed

/// One check and, where it is needed, one solve. Reads the ring, changes nothing.
class VertexSolver {
 public:
  VertexSolver(const PNormSmoother& smoother, ImplicitFunctionRef psi, const SmoothingParams& params)
      : smoother_(smoother),
        layer_(smoother.layer()),
        psi_(psi),
        closest_point_(params.closest_point),
        good_f_(f_of_quality(params.target + params.margin)),
        target_f_(f_of_quality(params.target)),
        least_gain_(params.least_gain),
        fine_gain_(params.fine_gain) {}

  struct Result {
    bool needed = false, moved = false;
    bool good = false;  ///< no tet of the ring was below the target
    Vec3 place;
    std::bitset<kMaxRing> below_target;  ///< which tets of the ring are below target + margin, before or after the move
    std::size_t psi_evaluations = 0;
  };

  Result operator()(int i) const {
    Result result;
    OneRing ring = smoother_.ring(i);
    if (ring.f_here >= good_f_) return result;
    result.needed = true;
    detail::silence_padding(ring);
    result.good = ring.f_here >= target_f_;
    const detail::Bar bar(ring, layer_.h_at(i), result.good ? fine_gain_ : least_gain_);
    if (layer_.role[i] == ActiveLayer::Role::Boundary && layer_.strata) {
      slide_on_stratum(i, ring, bar, result);
    } else if (layer_.role[i] == ActiveLayer::Role::Inner) {
      const detail::Displacement best = detail::best_displacement(ring, bar, layer_.h_at(i), {});
      result.moved = best.passed(ring, bar);
      result.place = layer_.V[i] + over_relaxed(ring, bar, best.y, kInnerFactor);
    } else {
      slide(i, ring, bar, result);
    }
    if (result.moved) result.below_target = detail::tets_below_target(ring, result.place - layer_.V[i], good_f_);
    return result;
  }

 private:
  static Vec3 over_relaxed(const OneRing& ring, const detail::Bar& bar, const Vec3& y, double factor) {
    return !bar.tangled() && bar.passed(ring, factor * y) ? factor * y : y;
  }

  /// Along the tangent plane, and back to the surface.
  void slide(int i, const OneRing& ring, const detail::Bar& bar, Result& result) const {
    const Vec3& x = layer_.V[i];
    const double h = layer_.h_at(i);
    Vec3 gradient;
    psi_.value(x, gradient);
    ++result.psi_evaluations;
    const double norm = gradient.norm();
    if (!(norm > 0) || !std::isfinite(norm)) return;
    detail::Directions tangent{true, {}};
    tangent.tangents.col(0) = gradient.unitOrthogonal();
    tangent.tangents.col(1) = (gradient / norm).cross(tangent.tangents.col(0));
    const detail::Displacement best = detail::best_displacement(ring, bar, h, tangent);
    if (!best.passed(ring, bar)) return;
    Vec3 y = over_relaxed(ring, bar, best.y, kBoundaryFactor);
    for (int trial = 0; trial < kSlides && (trial == 0 || bar.passed(ring, y)); ++trial, y *= .5) {
      const ClosestPoint foot = closest_point(psi_, x + y, h, closest_point_);
      result.psi_evaluations += static_cast<std::size_t>(foot.iterations);
      if (!foot.converged || !bar.passed(ring, foot.point - x)) continue;
      result.moved = true;
      result.place = foot.point;
      return;
    }
  }

  /// As slide(), on a patch or a curve; a corner stays where it is. Not inlined: the rounding of smooth boundaries
  /// would change with the code around it.
  [[gnu::noinline]] void slide_on_stratum(int i, const OneRing& ring, const detail::Bar& bar, Result& result) const {
    const Vec3& x = layer_.V[i];
    const double h = layer_.h_at(i);
    const FreeDirections free = layer_.strata->directions(layer_.stratum[i], x);
    ++result.psi_evaluations;
    if (free.n == 0) return;
    const detail::Directions along{.plane = true, .tangents = free.tangents, .line = free.n == 1};
    const detail::Displacement best = detail::best_displacement(ring, bar, h, along);
    if (!best.passed(ring, bar)) return;
    Vec3 y = over_relaxed(ring, bar, best.y, kBoundaryFactor);
    const BallOnPatch* ball = layer_.ball.empty() ? nullptr : &layer_.ball[i];
    for (int trial = 0; trial < kSlides && (trial == 0 || bar.passed(ring, y)); ++trial, y *= .5) {
      Vec3 foot;
      ++result.psi_evaluations;
      if (!layer_.strata->foot(layer_.stratum[i], x + y, h, foot, ball) || !bar.passed(ring, foot - x)) continue;
      result.moved = true;
      result.place = foot;
      return;
    }
  }

  const PNormSmoother& smoother_;
  const ActiveLayer& layer_;
  ImplicitFunctionRef psi_;
  const ClosestPointParams& closest_point_;
  double good_f_, target_f_, least_gain_, fine_gain_;
};

struct Counts {
  std::size_t checks = 0, solves = 0, moves = 0, psi_evaluations = 0;
  Counts operator+(const Counts& o) const {
    return {checks + o.checks, solves + o.solves, moves + o.moves, psi_evaluations + o.psi_evaluations};
  }
};

bool is_fixed(const ActiveLayer& layer, int i) { return layer.role[i] == ActiveLayer::Role::Fixed; }

}  // namespace

std::vector<std::string> problems(const SmoothingParams& params) {
  std::vector<std::string> list = problems(params.closest_point);
  for (std::string& problem : list) problem.insert(0, "closest_point.");
  const auto refuse = [&](const char* name, double value, const char* rule) {
    list.push_back(std::string(name).append(" = ").append(std::to_string(value)).append(": must be ").append(rule));
  };
  if (!(params.target > 0 && params.target < 1)) refuse("target", params.target, "> 0 and < 1");
  if (!(params.margin >= 0)) refuse("margin", params.margin, ">= 0");
  if (!(params.least_gain > 0 && params.least_gain < 1 / detail::kNorm))
    refuse("least_gain", params.least_gain, "> 0 and < 1 / 96");
  if (!(params.fine_gain > 0 && params.fine_gain < 1 / detail::kNorm))
    refuse("fine_gain", params.fine_gain, "> 0 and < 1 / 96");
  if (!(params.least_step >= 0)) refuse("least_step", params.least_step, ">= 0");
  if (params.max_sweeps < 0) refuse("max_sweeps", params.max_sweeps, ">= 0");
  return list;
}

SmoothingReport& SmoothingReport::operator+=(const SmoothingReport& later) {
  sweeps += later.sweeps;
  checks += later.checks;
  solves += later.solves;
  moves += later.moves;
  psi_evaluations += later.psi_evaluations;
  tangled = later.tangled;
  min_quality = later.min_quality;
  settled = later.settled;
  return *this;
}

PNormSmoother::PNormSmoother(ActiveLayer& layer)
    : layer_(layer), faces_of_(layer.V.size()), queued_(layer.V.size(), 0) {
  std::vector<std::size_t> count;
  for (std::size_t i = 0; i < layer.V.size(); ++i) {
    if (is_fixed(layer, static_cast<int>(i))) continue;
    const int n = layer.ring_begin[i + 1] - layer.ring_begin[i];
    if (n < 1 || n > kMaxRing) {
      throw std::invalid_argument("vertex " + std::to_string(i) + " has " + std::to_string(n) + " tets: must be 1 to " +
                                  std::to_string(kMaxRing));
    }
    queued_[i] = 1;
    const auto colour = static_cast<std::size_t>(layer.colour[i]);
    if (colour >= count.size()) count.resize(colour + 1, 0);
    ++count[colour];
  }
  colour_begin_.assign(1, 0);
  for (const std::size_t n : count) colour_begin_.push_back(colour_begin_.back() + n);
  by_colour_.resize(colour_begin_.back());
  std::vector<std::size_t> next(colour_begin_.begin(), colour_begin_.end() - 1);
  for (std::size_t i = 0; i < layer.V.size(); ++i) {
    if (queued_[i] != 0) by_colour_[next[layer.colour[i]]++] = static_cast<int>(i);
  }
  int n_faces = 0;
  for (const int i : by_colour_) {
    faces_of_[i] = {n_faces, layer.ring_begin[i + 1] - layer.ring_begin[i]};
    n_faces += faces_of_[i].n;
  }
  // Not initialised: each thread touches first, and so gets near its own memory, the pages that it fills.
  faces_ = std::make_unique_for_overwrite<Triangle[]>(static_cast<std::size_t>(n_faces));
  const auto list_faces = [&](const tbb::blocked_range<std::size_t>& range) {
    for (std::size_t k = range.begin(); k != range.end(); ++k) {
      const int i = by_colour_[k];
      for (int r = layer.ring_begin[i], f = faces_of_[i].begin; r < layer.ring_begin[i + 1]; ++r, ++f) {
        const Tet& t = layer.C[layer.ring[r]];
        const auto own = std::find(t.begin(), t.end(), i) - t.begin();
        faces_[f] = {t[kTetFace[own][0]], t[kTetFace[own][1]], t[kTetFace[own][2]]};
      }
    }
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, by_colour_.size(), kTetsPerTask / 16), list_faces);
}

void PNormSmoother::enqueue_all() {
  for (const int i : by_colour_) queued_[i] = 1;
}

void PNormSmoother::dequeue_all() { std::fill(queued_.begin(), queued_.end(), 0); }

void PNormSmoother::enqueue(int i) {
  // Vertices that share no tet may share a neighbour: both then write the same, so relaxed stores will do.
  std::atomic_ref(queued_[i]).store(1, std::memory_order_relaxed);
  for (const Triangle& face : faces(i)) {
    for (const int j : face) std::atomic_ref(queued_[j]).store(1, std::memory_order_relaxed);
  }
}

/// What a sweep does to the vertices of one colour.
class PNormSmoother::ColourSweep {
 public:
  ColourSweep(PNormSmoother& smoother, ImplicitFunctionRef psi, const SmoothingParams& params, const Context& context)
      : smoother_(smoother),
        layer_(smoother.layer_),
        psi_(psi),
        solve_(smoother, psi, params),
        least_step_(params.least_step),
        context_(context) {}

  /// Solves those in the queue among by_colour_[begin .. end - 1].
  Counts operator()(std::size_t begin, std::size_t end) {
    if (psi_.side_by_side()) return side_by_side(begin, end);
    const auto solve = [this](std::size_t k, Counts& counts) { solve_if_queued(k, counts); };
    if (end - begin >= kWorthThreads)
      return polled_parallel_sum<Counts>(begin, end, kSolvesPerTask, kSolvesPerPoll, context_, solve);
    Counts counts;
    for (std::size_t k = begin; k != end; ++k) solve(k, counts);
    return counts;
  }

 private:
  /// Threads solve vertices that share no tet but may share a neighbour, which both then put in the queue.
  std::atomic_ref<unsigned char> flag(int i) const { return std::atomic_ref(smoother_.queued_[i]); }
  bool is_queued(int i) const { return flag(i).load(std::memory_order_relaxed) != 0 && !is_fixed(layer_, i); }

  void solve_if_queued(std::size_t k, Counts& counts) {
    const std::vector<int>& vertices = smoother_.by_colour_;
    const int i = vertices[k];
    if (!is_queued(i)) return;
    if (k + kAhead < vertices.size() && is_queued(vertices[k + kAhead])) {
      for (const Triangle& face : smoother_.faces(vertices[k + kAhead])) __builtin_prefetch(&layer_.V[face[0]]);
    }
    solve(i, counts);
  }

  void solve(int i, Counts& counts) {
    flag(i).store(0, std::memory_order_relaxed);
    const VertexSolver::Result result = solve_(i);
    ++counts.checks;
    counts.solves += result.needed;
    counts.moves += result.moved;
    counts.psi_evaluations += result.psi_evaluations;
    if (!result.moved) return;
    const double step = (result.place - layer_.V[i]).norm();
    layer_.V[i] = result.place;
    if (result.good && step < least_step_ * layer_.h_at(i)) return;
    // A tet that was above the target and still is gives its vertices no reason to move.
    if (result.below_target.none()) return;
    flag(i).store(1, std::memory_order_relaxed);
    const std::span<const Triangle> ring = smoother_.faces(i);
    for (std::size_t j = 0; j < ring.size(); ++j) {
      if (!result.below_target[j]) continue;
      for (const int v : ring[j]) flag(v).store(1, std::memory_order_relaxed);
    }
  }

  Counts side_by_side(std::size_t begin, std::size_t end) {
    std::vector<int> todo;
    for (std::size_t k = begin; k != end; ++k) {
      if (is_queued(smoother_.by_colour_[k])) todo.push_back(smoother_.by_colour_[k]);
    }
    Counts counts;
    for_each_asking(psi_, todo.size(), kSolvesPerPoll, context_, [&](std::size_t k) { solve(todo[k], counts); });
    return counts;
  }

  PNormSmoother& smoother_;
  ActiveLayer& layer_;
  ImplicitFunctionRef psi_;
  const VertexSolver solve_;
  double least_step_;
  const Context& context_;
};

SmoothingReport PNormSmoother::run(ImplicitFunctionRef psi, const SmoothingParams& params, const Context& context) {
  if (const auto list = problems(params); !list.empty()) {
    std::string all;
    for (const std::string& problem : list) all += (all.empty() ? "" : "; ") + problem;
    throw std::invalid_argument(all);
  }
  ColourSweep sweep_colour(*this, psi, params, context);
  SmoothingReport report;
  while (report.sweeps < params.max_sweeps && !report.settled) {
    context.poll();
    Counts sweep;
    for (int colour = 0; colour < n_colours(); ++colour) {
      const auto c = static_cast<std::size_t>(colour);
      if (c + 1 < colour_begin_.size()) sweep = sweep + sweep_colour(colour_begin_[c], colour_begin_[c + 1]);
      pass_on(colour);
    }
    ++report.sweeps;
    report.checks += sweep.checks;
    report.solves += sweep.solves;
    report.moves += sweep.moves;
    report.psi_evaluations += sweep.psi_evaluations;
    report.settled = sum(sweep.moves) == 0;
  }
  return report;
}

void PNormSmoother::measure(SmoothingReport& report) const {
  const ActiveLayer& layer = layer_;
  const double min_f = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, layer.C.size(), kTetsPerTask), kInfinity,
      [&](const auto& range, double least) {
        for (std::size_t k = range.begin(); k != range.end(); ++k) {
          const Tet& t = layer.C[k];
          if (std::all_of(t.begin(), t.end(), [&](int i) { return is_fixed(layer, i); })) continue;
          const Vec3 &a = layer.V[t[0]], &b = layer.V[t[1]], &c = layer.V[t[2]], &d = layer.V[t[3]];
          const double V = volume6(a, b, c, d), L = sum_of_squared_edges(a, b, c, d);
          least = std::min(least, V * std::abs(V) / (L * L * L));
        }
        return least;
      },
      [](double x, double y) { return std::min(x, y); });
  report.min_quality = std::min(1., quality_of(min_f));
  report.tangled = 0;
  if (min_f > 0) return;
  std::vector<bool> tangled(layer.V.size(), false);
  for (const Tet& t : layer.C) {
    if (volume6(layer.V[t[0]], layer.V[t[1]], layer.V[t[2]], layer.V[t[3]]) > 0) continue;
    for (const int i : t) {
      if (!is_fixed(layer, i) && !tangled[i]) tangled[i] = true, ++report.tangled;
    }
  }
}

SmoothingReport smooth(ActiveLayer& layer, ImplicitFunctionRef psi, const SmoothingParams& params,
                       const Context& context) {
  PNormSmoother smoother(layer);
  SmoothingReport report = smoother.run(psi, params, context);
  smoother.measure(report);
  return report;
}

}  // namespace umtet
