#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "body/edges/edged_body.h"
#include "body/edges/edged_cloud.h"
#include "body/scan/level_set_fit.h"
#include "mesh/io/feature_files.h"
#include "mesh/io/tet_mesh_io.h"
#include "pipeline/case/artefact.h"
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
#include "reconstruct/io/triangle_mesh_io.h"

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

/// Returns triangles with sharp edges and their patches; without a body if there is nothing to keep.
EdgedTriangles edges_to_keep(const StageContext& context) {
  if (context.parameters.reconstruct().edges == SharpEdgeUse::Off || !exact_samples(context.paths)) return {};
  try {
    TriangleMesh mesh =
        context.handover.triangles ? *context.handover.triangles : read_triangles(context.paths.triangles()).mesh;
    const Vec3 shift = middle_of(mesh);
    return edged_triangles(std::move(mesh), shift, context.parameters);
  } catch (const CloudRefused& e) {  // umtet wrote the file, so the user's file is not at fault
    throw ArtefactDamaged(e.what());
  }
}

/// Writes the curves where patches meet.
LevelSetReport write_edges(const StageContext& context, const EdgedTriangles& edged) {
  LevelSetReport report;
  PiecewiseMesh curves;
  curves.graph = *edged.body->graph;
  curves.chains.resize(curves.graph.curves.size());
  report.shift = edged.shift;
  const StageState state = inspect_stage(context.paths, Stage::Cloud, Json::object(), std::nullopt);
  const TriangleReport samples = cloud_report(*state.record).triangles->body;
  report.fit.n_points = samples.n_samples;
  report.fit.cloud_spacing = samples.spacing;
  write_artefact(context.paths.folder(Stage::LevelSet) / kFeatureFile,
                 [&](const fs::path& file) { write_features(file, curves, edged.shift); });
  return report;
}

/// Returns a cloud with sharp edges and its patches; without a body if there is nothing to keep.
EdgedCloud edges_to_keep(const StageContext& context, const OrientedPointCloud& cloud, const Context& call) {
  if (context.parameters.reconstruct().edges != SharpEdgeUse::Auto || exact_samples(context.paths)) return {};
  return edged_cloud(cloud, context.handover.near, context.paths, call);
}

/// Writes the curves where patches meet, and the patch of each sample.
LevelSetReport write_edges(const StageContext& context, const EdgedCloud& edged, const OrientedPointCloud& cloud) {
  LevelSetReport report;
  PiecewiseMesh curves;
  curves.graph = *edged.body->graph;
  curves.chains.resize(curves.graph.curves.size());
  report.shift = edged.shift;
  report.fit.n_points = cloud.points.size();
  report.fit.cloud_spacing = edged.patches.spacing;
  report.noise = edged.patches.noise;
  const fs::path folder = context.paths.folder(Stage::LevelSet);
  write_artefact(folder / kFeatureFile, [&](const fs::path& file) { write_features(file, curves, edged.shift); });
  std::vector<std::int64_t> patch;
  for (const int p : edged.patches.patch) patch.push_back(p + 1);
  write_artefact(folder / kPatchFile, [&](const fs::path& temporary) {
    write_vtp(temporary, cloud.points, {{"patch", patch}});
  });
  return report;
}

void write_record_of(const StageContext& context, const std::vector<RecordedFile>& inputs, const LevelSetReport& report,
                     std::chrono::steady_clock::time_point start, const std::vector<std::string>& files) {
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  write_record(context.paths,
               {Stage::LevelSet,
                context.parameters.section("reconstruct"),
                inputs,
                {},
                to_json(report, wanted_mesh(context.parameters)),
                run_of_stage(seconds.count(), context.threads)},
               files);
}

}  // namespace

void run_level_set_stage(const StageContext& context) {
  const auto start = std::chrono::steady_clock::now();
  const std::vector<RecordedFile> inputs = recorded_inputs(context.paths, Stage::LevelSet, context.parameters);
  if (EdgedTriangles edged = edges_to_keep(context); edged.body) {
    context.progress.say("level-set: " + edges_text(edged.triangles->edges) +
                         ": each patch has a function of its own (--edges off makes one smooth level set)");
    begin_writing(context, Stage::LevelSet);
    write_record_of(context, inputs, write_edges(context, edged), start, {kFeatureFile});
    context.handover.edged = std::move(edged);
    return;
  }
  OrientedPointCloud cloud = take_cloud(context);
  const Context call{
      .progress = [&](const char* step, double part) { context.progress.report("level-set", step, part); },
      .cancelled = until_interrupted().cancelled};
  if (EdgedCloud edged = edges_to_keep(context, cloud, call); edged.body) {
    const FeatureGraph& graph = *edged.body->graph;
    context.progress.say(
        fmt::format("level-set: {} sharp edges, {} corners, {} patches: each patch has a function of its "
                    "own (--edges off makes one smooth level set)",
                    graph.curves.size(), graph.corners.size(), edged.patches.count));
    begin_writing(context, Stage::LevelSet);
    write_record_of(context, inputs, write_edges(context, edged, cloud), start, {kFeatureFile, kPatchFile});
    context.handover.cloud = std::move(cloud);
    context.handover.edged_cloud = std::move(edged);
    return;
  }
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
  write_record_of(context, inputs, fit.report, start, {"level_set.vti"});
  context.handover.cloud = std::move(cloud);
  context.handover.psi = std::move(fit.psi);
}

}  // namespace umtet
