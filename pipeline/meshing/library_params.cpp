#include "pipeline/meshing/library_params.h"

#include <string>

#include "pipeline/case/exit_code.h"

namespace umtet {

SsdParams ssd_params(const Parameters& p) {
  SsdParams ssd;
  ssd.spacing = p.real("reconstruct.spacing");
  ssd.smoothing = p.real("reconstruct.smoothing");
  ssd.detail = p.real("reconstruct.detail");
  ssd.smooth = p.real("reconstruct.smooth");
  ssd.alpha = p.real("reconstruct.alpha");
  ssd.weights = p.text("reconstruct.weights") == "paper" ? SsdWeights::Paper : SsdWeights::Area;
  ssd.prior.kind = p.text("reconstruct.prior") == "gaussian" ? LmePrior::Kind::Gaussian : LmePrior::Kind::CompactC2;
  ssd.prior.gamma = p.real("reconstruct.gamma");
  ssd.prior.support = static_cast<int>(p.integer("reconstruct.support"));
  ssd.prior.epsilon = p.real("reconstruct.epsilon");
  const std::string& solver = p.text("reconstruct.solver");
  const bool full_only = ssd.weights == SsdWeights::Paper || ssd.prior.kind == LmePrior::Kind::Gaussian;
  ssd.solver = solver == "assembled"                                 ? SsdSolver::Assembled
               : solver == "full" || (solver == "auto" && full_only) ? SsdSolver::Full
                                                                     : SsdSolver::Multilevel;
  ssd.band_tolerance = p.real("reconstruct.band_tolerance");
  ssd.tolerance = p.real("reconstruct.tolerance");
  ssd.max_iterations = static_cast<int>(p.integer("reconstruct.max_iterations"));
  ssd.padding = static_cast<int>(p.integer("reconstruct.padding"));
  std::string broken;
  for (const std::string& problem : problems(ssd)) broken += (broken.empty() ? "reconstruct: " : "; ") + problem;
  if (!broken.empty()) throw UsageError(broken);
  return ssd;
}

UmParams um_params(const Parameters& p) {
  UmParams um;
  um.mode = p.text("mesh.mode") == "paper" ? UmMode::Paper : UmMode::Fast;
  um.fast.smoothing.target = um.fast.repair.target = p.real("mesh.target_quality");
  um.paper.projection_passes = static_cast<int>(p.integer("mesh.projection_passes"));
  um.paper.relaxation_iterations = static_cast<int>(p.integer("mesh.relaxation_iterations"));
  um.paper.samples = static_cast<int>(p.integer("mesh.samples"));
  um.paper.directions = p.text("mesh.directions") == "axes" ? DirectionRule::AxesInTurn : DirectionRule::Random;
  const std::string& projection = p.text("mesh.closest_point");
  um.paper.closest_point.method = projection == "paper"    ? ClosestPointMethod::Paper
                                  : projection == "damped" ? ClosestPointMethod::Damped
                                                           : ClosestPointMethod::Newton;
  um.submesh.background_boundary = p.flag("mesh.complement") ? BackgroundBoundary::Wall : BackgroundBoundary::Refuse;
  um.paper.max_min = p.text("mesh.max_min") == "golden" ? MaxMin::GoldenSection : MaxMin::Exact;
  um.paper.seed = static_cast<std::uint64_t>(p.integer("mesh.seed"));
  um.paper.keep_iterates = p.flag("mesh.keep_iterates");
  std::string broken;
  for (const std::string& problem : problems(um)) broken += (broken.empty() ? "mesh: " : "; ") + problem;
  if (!broken.empty()) throw UsageError(broken);
  return um;
}

}  // namespace umtet
