#include "mesh/paper/algorithm_1.h"

#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "mesh/base/violations.h"
#include "mesh/core/asking_psi.h"
#include "mesh/core/tet_quality.h"
#include "mesh/paper/boundary_dvr.h"
#include "mesh/paper/dvr.h"
#include "mesh/submesh/assumptions.h"

namespace umtet {
namespace {

// Samples of Alg. 3 reach this far, in background edges; the paper leaves its "representative mesh size" open. A slide
// of half an edge to a whole one inverts a tet of the ring, so samples beyond half an edge would be wasted.
constexpr double kSampleReach = .5;

/// Algorithm 1, steps 23-35; a member per group of steps. Each returns false when the run is over, with status and
/// evidence set.
class Run {
 public:
  Run(const BackgroundMesh& background, ImplicitFunctionRef psi, const SubmeshParams& submesh,
      const PaperParams& params, ChosenSubmesh chosen, const Context& context)
      : background_(background),
        psi_(psi),
        submesh_params_(submesh),
        params_(params),
        context_(context),
        result_(result_of(std::move(chosen))) {}

  UmResult operator()() {
    if (result_.status == UmStatus::Success) {
      double_faces_ = double_positive_faces(submesh());
      result_.double_positive_faces = double_faces_.count;
      mesh_.emplace(submesh().mesh, background_.tiling().rings_are_optimal);
      if (project_and_relax()) improve_boundary();
    }
    if (mesh_) {
      result_.final = std::move(mesh_->V);
    } else {
      result_.final = submesh().mesh.V;
    }
    if (result_.projected.empty()) result_.projected = result_.final;
    return std::move(result_);
  }

 private:
  const Submesh& submesh() const { return result_.submesh; }
  void measure_conditioning_angles();
  bool project_and_relax();
  void improve_boundary();
  bool find_feet();
  bool advance(double lambda);
  void report(const char* step, double n_rounds) const;
  bool fail(UmStatus status, const UmEvidence& evidence);
  void relax_interior(int round, int r);
  bool fail_at(UmStatus status, UmEvidence evidence, std::span<const int> vertices);

  const BackgroundMesh& background_;
  ImplicitFunctionRef psi_;
  const SubmeshParams& submesh_params_;
  const PaperParams& params_;
  const Context& context_;
  UmResult result_;
  std::optional<MovingMesh> mesh_;
  std::optional<RelaxationOrder> relaxed_;  ///< I_R
  std::vector<ClosestPoint> feet_;          ///< pi of each positive vertex
  BrokenAssumption double_faces_, not_acute_;
};

bool Run::fail(UmStatus status, const UmEvidence& evidence) {
  result_.status = status;
  result_.evidence = evidence;
  return false;
}

/// @param n_rounds  rounds that are done; projection passes and iterations at the boundary cost about the same
void Run::report(const char* step, double n_rounds) const {
  context_.report(step, n_rounds / (params_.projection_passes + 1));
}

void Run::measure_conditioning_angles() {
  std::vector<double> distance;
  for (const ClosestPoint& foot : feet_) distance.push_back(std::abs(foot.t));
  ConditioningAngles angles = conditioning_angles(submesh(), distance);
  result_.conditioning_angle_max_deg = angles.max_deg;
  result_.obtuse_conditioning_angles = angles.not_acute.count;
  not_acute_ = std::move(angles.not_acute);
}

/// Fails with the assumption that is broken at one of these vertices, if there is one, else with the status given.
bool Run::fail_at(UmStatus status, UmEvidence evidence, std::span<const int> vertices) {
  if (double_faces_.is_broken_at(vertices)) {
    evidence.what += ", at a face shared by two positively cut tets";
    return fail(UmStatus::DoublePositiveFace, evidence);
  }
  if (not_acute_.is_broken_at(vertices)) {
    evidence.what += ", at a conditioning angle that is not acute";
    return fail(UmStatus::ObtuseConditioningAngle, evidence);
  }
  return fail(status, evidence);
}

/// pi of every positive vertex where it is now.
bool Run::find_feet() {
  const auto& positive = submesh().positive_vertices;
  feet_.resize(positive.size());
  for_each_asking(psi_, positive.size(), positive.size(), {}, [&](std::size_t k) {
    feet_[k] = closest_point(psi_, mesh_->V[positive[k]], background_.h(), params_.closest_point);
  });
  for (const ClosestPoint& foot : feet_) result_.n_psi_evaluations += static_cast<std::size_t>(foot.iterations);
  const Violations lost = find_violations(feet_.size(), [&](std::size_t k) { return !feet_[k].converged; });
  if (lost.count == 0) return true;
  const int i = positive[lost.first];
  return fail_at(UmStatus::ProjectionDiverged,
                 {.background_vertex = submesh().background_vertex[i],
                  .where = mesh_->V[i],
                  .count = lost.count,
                  .what = "the closest point of a positive vertex was not found"},
                 {&i, 1});
}

/// Steps 25-27, and the check on entry of dvr (Section 5.5).
bool Run::advance(double lambda) {
  const auto& positive = submesh().positive_vertices;
  for (std::size_t k = 0; k < positive.size(); ++k) {
    const Vec3& x = mesh_->V[positive[k]];
    mesh_->move(positive[k], lambda * feet_[k].point + (1 - lambda) * x);  // step 26
  }
  const auto& C = submesh().mesh.C;
  const auto& V = mesh_->V;
  const Violations inverted = find_violations(
      C.size(), [&](std::size_t t) { return !(volume6(V[C[t][0]], V[C[t][1]], V[C[t][2]], V[C[t][3]]) > 0); });
  if (inverted.count == 0) return true;
  const Tet& tet = C[inverted.first];
  return fail_at(UmStatus::InvertedTet,
                 {.background_tet = submesh().background_tet[inverted.first],
                  .where = .25 * (V[tet[0]] + V[tet[1]] + V[tet[2]] + V[tet[3]]),
                  .count = inverted.count,
                  .what = "moving positive vertices to the boundary inverted a tet"},
                 tet);
}

/// Steps 23-30.
bool Run::project_and_relax() {
  std::vector<bool> positive(mesh_->V.size(), false);
  for (const int i : submesh().positive_vertices) positive[i] = true;
  std::vector<int> interior;
  for (int i = 0; i < static_cast<int>(positive.size()); ++i) {
    const bool at_wall = submesh_params_.background_boundary == BackgroundBoundary::Wall &&
                         background_.on_boundary(submesh().background_vertex[i]);
    if (!positive[i] && !at_wall) interior.push_back(i);
  }
  relaxed_.emplace(*mesh_, std::move(interior));  // I_R = I^omega_h \ I^+, Section 3.2
  for (int pass = 1; pass <= params_.projection_passes; ++pass) {
    if (!find_feet()) return false;
    if (pass == 1) measure_conditioning_angles();
    if (!advance(static_cast<double>(pass) / params_.projection_passes)) return false;
    report("project", pass - 1);
    const int n = params_.relaxation_iterations;
    for (int r = 0; r < n; ++r) {
      relax_interior(pass - 1, r);  // step 28
      report("project", pass - 1 + static_cast<double>(r + 1) / n);
    }
    if (params_.keep_iterates) result_.iterates.push_back(mesh_->V);
  }
  result_.projected = mesh_->V;
  return true;
}

/// Iteration r of dvr in its round-th call. Every call begins with e_x, and random directions never come back.
void Run::relax_interior(int round, int r) {
  const int stride = (params_.relaxation_iterations + 2) / 3 * 3;
  const DvrParams dvr_params{params_.directions, params_.max_min, params_.seed, true};
  dvr(*mesh_, *relaxed_, submesh().background_vertex, dvr_params, round * stride + r, 1);
}

/// Steps 31-35.
void Run::improve_boundary() {
  const RelaxationOrder boundary(*mesh_, submesh().positive_vertices);
  BoundaryDvrParams boundary_params{params_.samples, kSampleReach * background_.h(), params_.seed,
                                    params_.closest_point};
  // A sample is off the boundary by a sagitta only, where Damped settles in as many steps as Newton and needs no
  // Hessian.
  if (boundary_params.closest_point.method == ClosestPointMethod::Newton) {
    boundary_params.closest_point.method = ClosestPointMethod::Damped;
  }
  const int n = params_.relaxation_iterations;
  for (int r = 0; r < n; ++r) {
    result_.n_psi_evaluations +=
        boundary_dvr(*mesh_, boundary, submesh().background_vertex, psi_, boundary_params, r);  // step 32
    relax_interior(params_.projection_passes, r);                                               // step 33
    report("relax", params_.projection_passes + static_cast<double>(r + 1) / n);
  }
}

}  // namespace

std::vector<std::string> problems(const PaperParams& params) {
  std::vector<std::string> list = problems(params.closest_point);
  for (std::string& problem : list) problem.insert(0, "closest_point.");
  const auto at_least = [&](const char* name, int value, int least) {
    if (value < least) {
      list.push_back(std::string(name) + " = " + std::to_string(value) + ": must be >= " + std::to_string(least));
    }
  };
  at_least("projection_passes", params.projection_passes, 1);
  at_least("relaxation_iterations", params.relaxation_iterations, 0);
  at_least("samples", params.samples, 1);
#ifndef UMTET_WITH_GSL
  if (params.max_min == MaxMin::Exact) list.push_back("max_min = Exact: built without GSL, use GoldenSection");
#endif
  return list;
}

UmResult algorithm_1(const BackgroundMesh& background, ImplicitFunctionRef psi, const SubmeshParams& submesh,
                     const PaperParams& params, ChosenSubmesh chosen, const Context& context) {
  return Run(background, psi, submesh, params, std::move(chosen), context)();
}

}  // namespace umtet
