#include "body/library_params.h"

#include <string>

#include "pipeline/case/exit_code.h"

namespace umtet {

SsdParams ssd_params(const Parameters& p) {
  SsdParams ssd;
  ssd.spacing = p.reconstruct().spacing;
  ssd.smoothing = p.reconstruct().smoothing;
  ssd.detail = p.reconstruct().detail;
  ssd.smooth = p.reconstruct().smooth;
  ssd.alpha = p.reconstruct().alpha;
  ssd.weights = p.reconstruct().weights == SampleWeights::Paper ? SsdWeights::Paper : SsdWeights::Area;
  ssd.prior.kind =
      p.reconstruct().prior == MaxEntPrior::Gaussian ? LmePrior::Kind::Gaussian : LmePrior::Kind::CompactC2;
  ssd.prior.gamma = p.reconstruct().gamma;
  ssd.prior.support = static_cast<int>(p.reconstruct().support);
  ssd.prior.epsilon = p.reconstruct().epsilon;
  const FitSolver solver = p.reconstruct().solver;
  const bool full_only = ssd.weights == SsdWeights::Paper || ssd.prior.kind == LmePrior::Kind::Gaussian;
  ssd.solver = solver == FitSolver::Assembled                                          ? SsdSolver::Assembled
               : solver == FitSolver::Full || (solver == FitSolver::Auto && full_only) ? SsdSolver::Full
                                                                                       : SsdSolver::Multilevel;
  const HoleClosing close = p.reconstruct().keep_open ? HoleClosing::None : p.reconstruct().close;
  ssd.closing = close == HoleClosing::None     ? Closing::None
                : close == HoleClosing::Flat   ? Closing::Flat
                : close == HoleClosing::Smooth ? Closing::Smooth
                                               : Closing::Auto;
  ssd.band_tolerance = p.reconstruct().band_tolerance;
  ssd.tolerance = p.reconstruct().tolerance;
  ssd.max_iterations = static_cast<int>(p.reconstruct().max_iterations);
  ssd.padding = static_cast<int>(p.reconstruct().padding);
  std::string broken;
  for (const std::string& problem : problems(ssd)) broken += (broken.empty() ? "reconstruct: " : "; ") + problem;
  if (!broken.empty()) throw UsageError(broken);
  return ssd;
}

UmParams um_params(const Parameters& p) {
  UmParams um;
  um.mode = p.mesh().mode == MeshingMode::Paper ? UmMode::Paper : UmMode::Fast;
  um.fast.set_quality_target(p.mesh().target_quality);
  um.paper.projection_passes = static_cast<int>(p.mesh().projection_passes);
  um.paper.relaxation_iterations = static_cast<int>(p.mesh().relaxation_iterations);
  um.paper.samples = static_cast<int>(p.mesh().samples);
  um.paper.directions =
      p.mesh().directions == RelaxationDirections::Axes ? DirectionRule::AxesInTurn : DirectionRule::Random;
  const Projection projection = p.mesh().closest_point;
  um.paper.closest_point.method = projection == Projection::Paper    ? ClosestPointMethod::Paper
                                  : projection == Projection::Damped ? ClosestPointMethod::Damped
                                                                     : ClosestPointMethod::Newton;
  um.submesh.background_boundary = p.mesh().complement ? BackgroundBoundary::Wall : BackgroundBoundary::Refuse;
  um.paper.max_min = p.mesh().max_min == MaxMinSearch::Golden ? MaxMin::GoldenSection : MaxMin::Exact;
  um.paper.seed = static_cast<std::uint64_t>(p.mesh().seed);
  um.paper.keep_iterates = p.mesh().keep_iterates;
  std::string broken;
  for (const std::string& problem : problems(um)) broken += (broken.empty() ? "mesh: " : "; ") + problem;
  if (!broken.empty()) throw UsageError(broken);
  return um;
}

}  // namespace umtet
