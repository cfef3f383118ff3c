#include "body/options.h"

#include <string>

#include "body/errors.h"

namespace umtet {

SsdParams ssd_params(const FitOptions& o) {
  SsdParams ssd;
  ssd.spacing = o.spacing;
  ssd.smoothing = o.smoothing;
  ssd.detail = o.detail;
  ssd.smooth = o.smooth;
  ssd.alpha = o.alpha;
  ssd.weights = o.weights;
  ssd.prior.kind = o.prior;
  ssd.prior.gamma = o.gamma;
  ssd.prior.support = static_cast<int>(o.support);
  ssd.prior.epsilon = o.epsilon;
  const bool full_only = ssd.weights == SsdWeights::Paper || ssd.prior.kind == LmePrior::Kind::Gaussian;
  ssd.solver = o.solver.value_or(full_only ? SsdSolver::Full : SsdSolver::Multilevel);
  ssd.closing = o.close;
  ssd.band_tolerance = o.band_tolerance;
  ssd.tolerance = o.tolerance;
  ssd.max_iterations = static_cast<int>(o.max_iterations);
  ssd.padding = static_cast<int>(o.padding);
  std::string broken;
  for (const std::string& problem : problems(ssd)) broken += (broken.empty() ? "reconstruct: " : "; ") + problem;
  if (!broken.empty()) throw UsageError(broken);
  return ssd;
}

UmParams um_params(const MeshOptions& o) {
  UmParams um;
  um.mode = o.mode;
  um.fast.set_quality_target(o.target_quality);
  um.fast.flips_follow = o.flips && o.mode == UmMode::Fast;
  um.paper.projection_passes = static_cast<int>(o.projection_passes);
  um.paper.relaxation_iterations = static_cast<int>(o.relaxation_iterations);
  um.paper.samples = static_cast<int>(o.samples);
  um.paper.directions = o.directions;
  um.paper.closest_point.method = o.closest_point;
  um.submesh.background_boundary = o.complement ? BackgroundBoundary::Wall : BackgroundBoundary::Refuse;
  um.paper.max_min = o.max_min;
  um.paper.seed = static_cast<std::uint64_t>(o.seed);
  um.paper.keep_iterates = o.keep_iterates;
  std::string broken;
  for (const std::string& problem : problems(um)) broken += (broken.empty() ? "mesh: " : "; ") + problem;
  if (!broken.empty()) throw UsageError(broken);
  return um;
}

}  // namespace umtet
