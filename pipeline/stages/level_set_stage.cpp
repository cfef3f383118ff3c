#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>
#include <utility>

#include "pipeline/case/exit_code.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/case/memory.h"
#include "pipeline/meshing/library_params.h"
#include "pipeline/reports/stage_reports.h"
#include "pipeline/stages/given_normals.h"
#include "pipeline/stages/stages.h"
#include "reconstruct/cloud/cloud_neighbours.h"
#include "reconstruct/cloud/cloud_survey.h"
#include "reconstruct/cloud/covering.h"
#include "reconstruct/io/level_set_io.h"
#include "reconstruct/io/point_cloud_io.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

OrientedPointCloud take_cloud(const StageContext& context) {
  if (context.handover.cloud) return std::move(*std::exchange(context.handover.cloud, std::nullopt));
  try {
    return read_point_cloud(context.paths.cloud()).cloud;
  } catch (const CloudRefused& e) {  // we wrote it: not the user's file is at fault
    throw ArtefactDamaged(e.what());
  }
}

// Share of normals that may point against grad psi. Noise and sharp edges oppose single ones; a tenth means that a
// patch of them is turned over.
constexpr double kMostOpposed = .1;

/// Distances between opposed samples; none where none face one another.
std::optional<std::array<double, 3>> thickness_percentiles(const OrientedPointCloud& cloud, const NeighbourTree& tree) {
  // 20 of them fall below the first percentile, and all together take a small part of a second.
  constexpr std::size_t kRays = 2000;
  const std::vector<double> t = thicknesses(cloud, tree, kRays);
  if (t.empty()) return std::nullopt;
  const auto at = [&](double p) { return t[static_cast<std::size_t>(p * static_cast<double>(t.size() - 1))]; };
  return {{at(.01), at(.05), at(.5)}};
}

/// Which holes of the scan were closed, and how; empty where the fit alone closes all.
std::string described(const std::vector<FittedHole>& holes) {
  const auto count = [&](FittedHole::How how) {
    return std::count_if(holes.begin(), holes.end(), [how](const FittedHole& h) { return h.how == how; });
  };
  const auto flat = count(FittedHole::How::Flat), smooth = count(FittedHole::How::Smooth);
  if (flat + smooth == 0) return "";
  return fmt::format(
      "level-set: closed where no sample is: {} hole{} flat, {} smoothly (--close chooses, --keep-open does not)", flat,
      flat == 1 ? "" : "s", smooth);
}

}  // namespace

void require_outward_normals(const SsdReport& r) {
  const auto opposed = static_cast<double>(r.n_opposed_normals) / static_cast<double>(r.n_points);
  const bool open = r.least_wall_value < 0;
  if (!open && opposed <= kMostOpposed) return;
  throw SolveError(fmt::format(
      "{}: {:.1f} % of the {} normals point against its gradient; {}orient the normals consistently, outward",
      open ? "psi < 0 reaches the wall of its box: the samples do not bound a body with outward normals"
           : "psi was fitted, but the normals disagree with one another",
      100 * opposed, r.n_points, open ? "check that the surface is closed, and " : ""));
}

void run_level_set_stage(const StageContext& context) {
  const auto start = std::chrono::steady_clock::now();
  SsdParams params = ssd_params(context.parameters);
  const std::vector<RecordedFile> inputs = recorded_inputs(context.paths, Stage::LevelSet, context.parameters);
  OrientedPointCloud cloud = take_cloud(context);
  const Vec3 shift = far_origin_shift(cloud);
  for (Vec3& x : cloud.points) x -= shift;

  params.max_memory = allowed_bytes(context.parameters);
  context.progress.report("level-set", "noise", 0);
  const double noise = context.parameters.reconstruct().noise;
  LevelSetReport report;
  report.shift = shift;
  NeighbourDistances near = std::exchange(context.handover.near, {});
  if (near.nearest.empty()) near = covered_distances(cloud.points);
  {
    const bool is_even = near.representatives.empty();
    const OrientedPointCloud few = is_even ? OrientedPointCloud() : picked(cloud, near.representatives);
    const OrientedPointCloud& even = is_even ? cloud : few;
    const NeighbourTree tree(even.points);
    params.noise = noise >= 0 ? noise : noise_along_normals(even, tree);
    stop_if_interrupted();
    report.thickness = thickness_percentiles(even, tree);
  }
  stop_if_interrupted();
  SsdFit fit = [&] {
    try {
      const Context call{
          .progress = [&](const char* step, double part) { context.progress.report("level-set", step, part); },
          .cancelled = until_interrupted().cancelled};
      return fit_ssd(cloud, params, call, &near);
    } catch (const SolveTooLarge& e) {
      throw ResourceLimit(e.what());
    }
  }();

  stop_if_interrupted();
  try {
    require_outward_normals(fit.report);
  } catch (const SolveError& e) {
    throw SolveError(e.what() + doubt_about_given_normals(context.paths));
  }
  if (const std::string closed = described(fit.report.holes); !closed.empty()) context.progress.say(closed);
  begin_writing(context, Stage::LevelSet);
  write_artefact(context.paths.level_set(),
                 [&](const fs::path& temporary) { write_level_set(temporary, fit.psi, shift); });
  report.noise = params.noise;
  report.fit = std::move(fit.report);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  write_record(context.paths,
               {Stage::LevelSet,
                context.parameters.section("reconstruct"),
                inputs,
                {},
                to_json(report),
                run_of_stage(seconds.count(), context.threads)},
               {"level_set.vti"});
  for (Vec3& x : cloud.points) x += shift;
  context.handover.cloud = std::move(cloud);
  context.handover.psi = std::move(fit.psi);
}

}  // namespace umtet
