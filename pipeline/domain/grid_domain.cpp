#include <fmt/format.h>

#include <optional>
#include <stdexcept>

#include "pipeline/case/exit_code.h"
#include "pipeline/case/memory.h"
#include "pipeline/domain/domain.h"
#include "reconstruct/io/grid_io.h"

namespace umtet {
namespace {

// A value, its coefficient; of a segmentation also two distances, and the nodes around it.
constexpr double kBytesPerNode = 50;

/// psi of a segmentation, and what was done to it in words.
GridLevelSet psi_of_parts(Grid grid, const MeshParameters& p, Domain& domain) {
  const double step = grid.steps().minCoeff();
  const auto part = p.part > 0 ? std::optional(static_cast<double>(p.part)) : std::nullopt;
  MaskFit fit = fit_mask(std::move(grid), part, p.part_smooth);
  domain.notices.push_back(
      fmt::format("{}: a segmentation of {} voxels{}, made smooth over {:.2g} voxels (--part-smooth): {} voxels have "
                  "changed sides, by at most {:.2g} voxels",
                  p.level_set, fit.report.n_inside, part ? fmt::format(" of part {}", p.part) : "", p.part_smooth,
                  fit.report.n_changed, fit.report.farthest_changed / step));
  return std::move(fit.psi);
}

}  // namespace

Domain grid_domain(const Parameters& parameters) {
  const MeshParameters& p = parameters.mesh();
  if (!p.implicit.empty()) throw UsageError("--implicit and --level-set: one of them is psi");
  Domain domain;
  domain.complement = p.complement;
  const double allowed = allowed_bytes(parameters);
  Grid grid = read_grid(p.level_set, allowed > 0 ? std::min(1e9, allowed / kBytesPerNode) : 1e9);
  const bool has_level = parameters.source(keys::mesh::level) != ParamSource::Default;
  try {
    if (is_segmentation(grid) && !has_level) {
      domain.grid = std::make_shared<const GridLevelSet>(psi_of_parts(std::move(grid), p, domain));
    } else {
      if (p.part > 0) throw UsageError("--part: " + p.level_set + " holds no whole numbers of parts");
      for (double& v : grid.values) v -= p.level;
      domain.grid = std::make_shared<const GridLevelSet>(interpolate(std::move(grid)));
    }
  } catch (const std::invalid_argument& e) {
    throw GridRefused(p.level_set + ": " + e.what());
  }
  domain.box = parse_box(p.box).value_or(domain.grid->box());
  domain.diagonal = domain.box.diagonal().norm();
  return domain;
}

}  // namespace umtet
