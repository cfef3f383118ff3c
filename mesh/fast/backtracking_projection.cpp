#include "mesh/fast/backtracking_projection.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "mesh/core/max_min.h"

namespace umtet {
namespace {

constexpr std::array<double, 4> kShares = {1, .5, .25, .125};  // of a step; the first that the guard lets pass
// Of 1, 2, 3 and never, 3 alone brought everyone home on tori and eq. (9) of 1000 tets with guards of .2 to .4.
constexpr int kRoundsPerDetour = 3;
constexpr std::size_t kVerticesPerTask = 64;  // of a microsecond or two each
constexpr std::size_t kVerticesPerPoll = 1 << 12;

/// A Boundary vertex under way.
struct Traveller {
  int vertex = 0;
  bool has_foot = false, arrived = false, held_back = false;
  double t = 0;  ///< the vertex is at start + t (foot - start)
  Vec3 start, foot;
};

/// Roles as they were, whatever happens.
class RolesOnLoan {
 public:
  explicit RolesOnLoan(std::vector<Shell::Role>& roles) : roles_(roles), kept_(roles) {}
  ~RolesOnLoan() { roles_ = std::move(kept_); }
  RolesOnLoan(const RolesOnLoan&) = delete;
  RolesOnLoan& operator=(const RolesOnLoan&) = delete;

 private:
  std::vector<Shell::Role>& roles_;
  std::vector<Shell::Role> kept_;
};

class Projection {
 public:
  Projection(PNormSmoother& smoother, ImplicitFunctionRef psi, const ProjectionParams& params,
             const KeepGoing& keep_going)
      : smoother_(smoother),
        shell_(smoother.shell()),
        psi_(psi),
        params_(params),
        keep_going_(keep_going),
        roles_(smoother.shell().role) {
    least_f_ = f_of_quality(params.least_quality);
    set_out();
  }

  ProjectionReport operator()() {
    find_feet();
    while (report_.rounds < params_.max_rounds && n_arrived_ < travellers_.size()) {
      ++report_.rounds;
      advance(std::min(1., static_cast<double>(report_.rounds) / params_.passes));
      if (n_arrived_ == travellers_.size()) break;
      const bool last_pass_is_over = report_.rounds >= params_.passes;
      if (last_pass_is_over) make_room();
      relax(params_.sweeps);
      if (last_pass_is_over) find_feet();
    }
    return conclude();
  }

 private:
  template <class F>
  std::size_t count_over(std::size_t begin, std::size_t end, const F& f);
  void set_out();
  void find_feet();
  void make_room();
  void advance(double target);
  bool step(Traveller& traveller, double target);
  void relax(int sweeps);
  ProjectionReport conclude();

  PNormSmoother& smoother_;
  Shell& shell_;
  ImplicitFunctionRef psi_;
  const ProjectionParams& params_;
  const KeepGoing& keep_going_;
  RolesOnLoan roles_;  ///< travellers are Fixed for the smoother until they arrive
  double least_f_;
  std::vector<Traveller> travellers_;      ///< by colour, ascending vertex within one
  std::vector<std::size_t> colour_begin_;  ///< into travellers_
  std::size_t n_arrived_ = 0;
  ProjectionReport report_;
};

/// Sum of the integers f(k), threads over k.
template <class F>
std::size_t Projection::count_over(std::size_t begin, std::size_t end, const F& f) {
  std::size_t total = 0;
  for (; begin < end; begin += kVerticesPerPoll) {
    poll(keep_going_);
    const tbb::blocked_range<std::size_t> some(begin, std::min(end, begin + kVerticesPerPoll), kVerticesPerTask);
    total += tbb::parallel_reduce(
        some, std::size_t{0},
        [&](const auto& range, std::size_t sum) {
          for (std::size_t k = range.begin(); k != range.end(); ++k) sum += f(k);
          return sum;
        },
        std::plus<>());
  }
  return total;
}

void Projection::set_out() {
  colour_begin_.assign(1, 0);
  for (std::size_t i = 0; i < shell_.V.size(); ++i) {
    if (shell_.role[i] != Shell::Role::Boundary) continue;
    const auto colour = static_cast<std::size_t>(shell_.colour[i]);
    if (colour + 1 >= colour_begin_.size()) colour_begin_.resize(colour + 2, 0);
    ++colour_begin_[colour + 1];
  }
  std::partial_sum(colour_begin_.begin(), colour_begin_.end(), colour_begin_.begin());
  travellers_.resize(colour_begin_.back());
  std::vector<std::size_t> next = colour_begin_;
  for (std::size_t i = 0; i < shell_.V.size(); ++i) {
    if (shell_.role[i] != Shell::Role::Boundary) continue;
    travellers_[next[static_cast<std::size_t>(shell_.colour[i])]++].vertex = static_cast<int>(i);
    shell_.role[i] = Shell::Role::Fixed;
  }
  report_.boundary = travellers_.size();
}

/// Of those who have not arrived, from where they are.
void Projection::find_feet() {
  report_.psi_evaluations += count_over(0, travellers_.size(), [&](std::size_t k) {
    Traveller& traveller = travellers_[k];
    if (traveller.arrived) return std::size_t{0};
    traveller.t = 0;
    traveller.start = shell_.V[traveller.vertex];
    const ClosestPoint foot = closest_point(psi_, traveller.start, shell_.h, params_.closest_point);
    traveller.has_foot = foot.converged;
    traveller.foot = foot.point;
    return static_cast<std::size_t>(foot.iterations);
  });
}

/// As far as the guard allows. Returns whether the vertex arrived.
bool Projection::step(Traveller& traveller, double target) {
  const int i = traveller.vertex;
  if ((traveller.foot - traveller.start).norm() <= params_.closest_point.tol * shell_.h) {
    return traveller.arrived = true;  // a warm start has brought it there
  }
  const Vec3 x = shell_.V[i];
  const OneRing ring = smoother_.ring(i);
  const double least = std::min(least_f_, ring.f_here);
  for (const double share : kShares) {
    const double t = traveller.t + share * (target - traveller.t);
    const Vec3 place = traveller.start + t * (traveller.foot - traveller.start);
    if (!(ring.min_f(place - x) >= least)) {
      traveller.held_back = true;
      continue;
    }
    traveller.t = t;
    traveller.arrived = t == 1;
    shell_.V[i] = place;
    smoother_.wake(i);
    break;
  }
  return traveller.arrived;
}

void Projection::advance(double target) {
  for (std::size_t c = 0; c + 1 < colour_begin_.size(); ++c) {
    n_arrived_ += count_over(colour_begin_[c], colour_begin_[c + 1], [&](std::size_t k) -> std::size_t {
      Traveller& traveller = travellers_[k];
      return traveller.has_foot && !traveller.arrived && step(traveller, target) ? 1 : 0;
    });
  }
}

/// Those on the surface may slide from now on. Those held back keep what they have won, and every now and then go where
/// their rings are best instead: the way to the surface from there is another one.
void Projection::make_room() {
  const Shell::Role held_back = report_.rounds % kRoundsPerDetour == 0 ? Shell::Role::Inner : Shell::Role::Fixed;
  for (const Traveller& traveller : travellers_) {
    shell_.role[traveller.vertex] = traveller.arrived ? Shell::Role::Boundary : held_back;
  }
}

void Projection::relax(int sweeps) {
  SmoothParams smoothing = params_.smoothing;
  smoothing.max_sweeps = sweeps;
  report_.smoothing += smoother_.run(psi_, smoothing, keep_going_);
}

ProjectionReport Projection::conclude() {
  for (const Traveller& traveller : travellers_) {
    shell_.role[traveller.vertex] = Shell::Role::Boundary;
    report_.stopped_short += traveller.held_back;
    if (traveller.arrived) continue;
    report_.not_arrived.push_back(
        {traveller.vertex, traveller.has_foot ? NotArrived::Reason::Guard : NotArrived::Reason::NoFoot});
  }
  std::sort(report_.not_arrived.begin(), report_.not_arrived.end(),
            [](const NotArrived& a, const NotArrived& b) { return a.vertex < b.vertex; });
  report_.psi_evaluations += report_.smoothing.psi_evaluations;
  return std::move(report_);
}

}  // namespace

std::vector<std::string> problems(const ProjectionParams& params) {
  std::vector<std::string> list;
  for (const std::string& problem : problems(params.smoothing)) list.push_back("smoothing." + problem);
  for (const std::string& problem : problems(params.closest_point)) list.push_back("closest_point." + problem);
  const auto refuse = [&](const char* name, const std::string& value, const std::string& rule) {
    list.push_back(std::string(name).append(" = ").append(value).append(": must be ").append(rule));
  };
  if (params.passes < 1) refuse("passes", std::to_string(params.passes), ">= 1");
  if (params.max_rounds < params.passes) refuse("max_rounds", std::to_string(params.max_rounds), ">= passes");
  if (!(params.least_quality > 0 && params.least_quality < 1)) {
    refuse("least_quality", std::to_string(params.least_quality), "> 0 and < 1");
  }
  if (params.sweeps < 0) refuse("sweeps", std::to_string(params.sweeps), ">= 0");
  return list;
}

ProjectionReport project(PNormSmoother& smoother, ImplicitFunctionRef psi, const ProjectionParams& params,
                         const KeepGoing& keep_going) {
  if (const auto list = problems(params); !list.empty()) {
    std::string all;
    for (const std::string& problem : list) all += (all.empty() ? "" : "; ") + problem;
    throw std::invalid_argument(all);
  }
  return Projection(smoother, psi, params, keep_going)();
}

ProjectionReport project(Shell& shell, ImplicitFunctionRef psi, const ProjectionParams& params,
                         const KeepGoing& keep_going) {
  PNormSmoother smoother(shell);
  ProjectionReport report = project(smoother, psi, params, keep_going);
  smoother.measure(report.smoothing);
  report.min_quality = report.smoothing.min_quality;
  return report;
}

}  // namespace umtet
