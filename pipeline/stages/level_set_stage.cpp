#include <chrono>
#include <optional>
#include <utility>

#include "body/scan/level_set_fit.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/case/option_words.h"
#include "pipeline/domain/body_options.h"
#include "pipeline/reports/stage_reports.h"
#include "pipeline/stages/given_normals.h"
#include "pipeline/stages/stages.h"
#include "reconstruct/cloud/neighbours/cloud_neighbours.h"
#include "reconstruct/io/level_set_io.h"
#include "reconstruct/io/point_cloud_io.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

OrientedPointCloud take_cloud(const StageContext& context) {
  if (context.handover.cloud) return std::move(*std::exchange(context.handover.cloud, std::nullopt));
  try {
    return read_point_cloud(context.paths.cloud()).cloud;
  } catch (const CloudRefused& e) {  // umtet wrote the file, so the user's file is not at fault
    throw ArtefactDamaged(e.what());
  }
}

/// Returns exact samples for a cloud of triangles whose normals are the normals of the triangles.
std::optional<ExactSamples> exact_samples(const CasePaths& paths) {
  const StageState state = inspect_stage(paths, Stage::Cloud, Json::object(), std::nullopt);
  if (!state.record) return std::nullopt;
  const CloudReport report = cloud_report(*state.record);
  if (!report.triangles || !report.normals.given) return std::nullopt;
  return ExactSamples{report.triangles->body.least_spacing};
}

}  // namespace

void run_level_set_stage(const StageContext& context) {
  const auto start = std::chrono::steady_clock::now();
  const std::vector<RecordedFile> inputs = recorded_inputs(context.paths, Stage::LevelSet, context.parameters);
  OrientedPointCloud cloud = take_cloud(context);
  const Context call{
      .progress = [&](const char* step, double part) { context.progress.report("level-set", step, part); },
      .cancelled = until_interrupted().cancelled};
  LevelSetFit fit = [&] {
    try {
      return fit_level_set(cloud, std::exchange(context.handover.near, {}), body_options(context.parameters), call,
                           context.ranks ? context.ranks->bands() : nullptr, exact_samples(context.paths));
    } catch (const SolveTooLarge& e) {
      throw ResourceLimit(e.message);
    } catch (const SolveError& e) {
      throw SolveError(e.what() + doubt_about_given_normals(context.paths));
    }
  }();
  for (const std::string& notice : texts_of(fit.notices, as_flag)) context.progress.say("level-set: " + notice);
  begin_writing(context, Stage::LevelSet);
  write_artefact(context.paths.level_set(),
                 [&](const fs::path& temporary) { write_level_set(temporary, fit.psi, fit.report.shift); });
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  write_record(context.paths,
               {Stage::LevelSet,
                context.parameters.section("reconstruct"),
                inputs,
                {},
                to_json(fit.report, wanted_mesh(context.parameters)),
                run_of_stage(seconds.count(), context.threads)},
               {"level_set.vti"});
  context.handover.cloud = std::move(cloud);
  context.handover.psi = std::move(fit.psi);
}

}  // namespace umtet
