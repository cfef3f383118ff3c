#include "mesh/fast/projection/backtracking_projection.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "mesh/core/asking_psi.h"
#include "mesh/core/max_min.h"

namespace umtet {
namespace {

// Parts of a step that are tried, longest first. The first is taken that leaves every tet of the ring at
// Q >= least_quality (.2), or at least at the worst Q that the ring had.
constexpr std::array<double, 4> kShares = {1, .5, .25, .125};
// In every third round vertices that were held back are smoothed freely first, and try another way from there. Oftener,
// and they lose the way they have made; never, and some are held back for ever.
constexpr int kRoundsPerDetour = 3;
constexpr std::size_t kVerticesPerTask = 64;  // of a microsecond or two each

/// A Boundary vertex under way.
struct BoundaryVertex {
  int vertex = 0;
  bool has_foot = false, arrived = false, held_back = false;
  double t = 0;  ///< the vertex is at start + t (foot - start)
  Vec3 start, foot;
};

/// Restores the roles of the vertices at the end, also when something throws.
class RolesOnLoan {
 public:
  explicit RolesOnLoan(std::vector<ActiveLayer::Role>& roles) : roles_(roles), kept_(roles) {}
  ~RolesOnLoan() { roles_ = std::move(kept_); }
  RolesOnLoan(const RolesOnLoan&) = delete;
  RolesOnLoan& operator=(const RolesOnLoan&) = delete;

 private:
  std::vector<ActiveLayer::Role>& roles_;
  std::vector<ActiveLayer::Role> kept_;
};

class Projection {
 public:
  Projection(PNormSmoother& smoother, ImplicitFunctionRef psi, const ProjectionParams& params, const Context& context)
      : smoother_(smoother),
        layer_(smoother.layer()),
        psi_(psi),
        params_(params),
        context_(context),
        roles_(smoother.layer().role) {
    least_f_ = f_of_quality(params.least_quality);
    set_out();
  }

  ProjectionReport operator()() {
    find_feet();
    while (report_.rounds < params_.max_rounds && !all_arrived()) {
      ++report_.rounds;
      advance(std::min(1., static_cast<double>(report_.rounds) / params_.passes));
      if (all_arrived()) break;
      const bool last_pass_is_over = report_.rounds >= params_.passes;
      if (last_pass_is_over) make_room();
      relax(params_.sweeps);
      if (last_pass_is_over) find_feet();
    }
    return conclude();
  }

 private:
  bool all_arrived() const { return smoother_.sum(boundary_vertices_.size() - n_arrived_) == 0; }
  void set_out();
  void find_feet();
  void make_room();
  void advance(double target);
  bool step(BoundaryVertex& boundary_vertex, double target);
  void relax(int sweeps);
  ProjectionReport conclude();

  PNormSmoother& smoother_;
  ActiveLayer& layer_;
  ImplicitFunctionRef psi_;
  const ProjectionParams& params_;
  const Context& context_;
  RolesOnLoan roles_;  ///< boundary_vertices are Fixed for the smoother until they arrive
  double least_f_;
  std::vector<BoundaryVertex> boundary_vertices_;  ///< by colour, ascending vertex within one
  std::vector<std::size_t> colour_begin_;          ///< into boundary_vertices_
  std::size_t n_arrived_ = 0;
  ProjectionReport report_;
};

void Projection::set_out() {
  colour_begin_.assign(1, 0);
  for (std::size_t i = 0; i < layer_.V.size(); ++i) {
    if (layer_.role[i] != ActiveLayer::Role::Boundary) continue;
    const auto colour = static_cast<std::size_t>(layer_.colour[i]);
    if (colour + 1 >= colour_begin_.size()) colour_begin_.resize(colour + 2, 0);
    ++colour_begin_[colour + 1];
  }
  std::partial_sum(colour_begin_.begin(), colour_begin_.end(), colour_begin_.begin());
  boundary_vertices_.resize(colour_begin_.back());
  std::vector<std::size_t> next = colour_begin_;
  for (std::size_t i = 0; i < layer_.V.size(); ++i) {
    if (layer_.role[i] != ActiveLayer::Role::Boundary) continue;
    boundary_vertices_[next[static_cast<std::size_t>(layer_.colour[i])]++].vertex = static_cast<int>(i);
    layer_.role[i] = ActiveLayer::Role::Fixed;
  }
  report_.boundary = boundary_vertices_.size();
}

/// Closest points of the vertices that have not arrived, from where they are.
void Projection::find_feet() {
  const std::size_t n = boundary_vertices_.size();
  report_.psi_evaluations +=
      sum_asking<std::size_t>(psi_, 0, n, kVerticesPerTask, context_, [&](std::size_t k, std::size_t& sum) {
        BoundaryVertex& boundary_vertex = boundary_vertices_[k];
        if (boundary_vertex.arrived) return;
        boundary_vertex.t = 0;
        boundary_vertex.start = layer_.V[boundary_vertex.vertex];
        const ClosestPoint foot =
            closest_point(psi_, boundary_vertex.start, layer_.h_at(boundary_vertex.vertex), params_.closest_point);
        boundary_vertex.has_foot = foot.converged;
        boundary_vertex.foot = foot.point;
        sum += static_cast<std::size_t>(foot.iterations);
      });
}

/// As far as the bound on quality allows. Returns whether the vertex arrived.
bool Projection::step(BoundaryVertex& boundary_vertex, double target) {
  const int i = boundary_vertex.vertex;
  if ((boundary_vertex.foot - boundary_vertex.start).norm() <= params_.closest_point.tol * layer_.h_at(i)) {
    return boundary_vertex.arrived = true;  // a warm start has brought it there
  }
  const Vec3 x = layer_.V[i];
  const OneRing ring = smoother_.ring(i);
  const double least = std::min(least_f_, ring.f_here);
  for (const double share : kShares) {
    const double t = boundary_vertex.t + share * (target - boundary_vertex.t);
    const Vec3 place = boundary_vertex.start + t * (boundary_vertex.foot - boundary_vertex.start);
    if (!(ring.min_f(place - x) >= least)) {
      boundary_vertex.held_back = true;
      continue;
    }
    boundary_vertex.t = t;
    boundary_vertex.arrived = t == 1;
    layer_.V[i] = place;
    smoother_.enqueue(i);
    break;
  }
  return boundary_vertex.arrived;
}

void Projection::advance(double target) {
  for (int colour = 0; colour < smoother_.n_colours(); ++colour) {
    const auto c = static_cast<std::size_t>(colour);
    const auto advance_one = [&](std::size_t k, std::size_t& n_arrived) {
      BoundaryVertex& boundary_vertex = boundary_vertices_[k];
      n_arrived += boundary_vertex.has_foot && !boundary_vertex.arrived && step(boundary_vertex, target);
    };
    if (c + 1 < colour_begin_.size()) {
      n_arrived_ += sum_asking<std::size_t>(psi_, colour_begin_[c], colour_begin_[c + 1], kVerticesPerTask, context_,
                                            advance_one);
    }
    smoother_.pass_on(colour);
  }
}

/// Vertices on the surface may slide from now on. Those held back stay where they are, and in every kRoundsPerDetour-th
/// round are smoothed like inner ones: the way to the surface from there is another one.
void Projection::make_room() {
  const ActiveLayer::Role held_back =
      report_.rounds % kRoundsPerDetour == 0 ? ActiveLayer::Role::Inner : ActiveLayer::Role::Fixed;
  for (const BoundaryVertex& boundary_vertex : boundary_vertices_) {
    layer_.role[boundary_vertex.vertex] = boundary_vertex.arrived ? ActiveLayer::Role::Boundary : held_back;
  }
}

void Projection::relax(int sweeps) {
  SmoothingParams smoothing = params_.smoothing;
  smoothing.max_sweeps = sweeps;
  report_.smoothing += smoother_.run(psi_, smoothing, context_);
}

ProjectionReport Projection::conclude() {
  for (const BoundaryVertex& boundary_vertex : boundary_vertices_) {
    layer_.role[boundary_vertex.vertex] = ActiveLayer::Role::Boundary;
    report_.stopped_short += boundary_vertex.held_back;
    if (boundary_vertex.arrived) continue;
    report_.not_arrived.push_back(
        {boundary_vertex.vertex, boundary_vertex.has_foot ? NotArrived::Reason::Guard : NotArrived::Reason::NoFoot});
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
                         const Context& context) {
  if (const auto list = problems(params); !list.empty()) {
    std::string all;
    for (const std::string& problem : list) all += (all.empty() ? "" : "; ") + problem;
    throw std::invalid_argument(all);
  }
  return Projection(smoother, psi, params, context)();
}

ProjectionReport project(ActiveLayer& layer, ImplicitFunctionRef psi, const ProjectionParams& params,
                         const Context& context) {
  PNormSmoother smoother(layer);
  ProjectionReport report = project(smoother, psi, params, context);
  smoother.measure(report.smoothing);
  report.min_quality = report.smoothing.min_quality;
  return report;
}

}  // namespace umtet
