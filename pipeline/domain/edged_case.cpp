#include "pipeline/domain/edged_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "body/edges/edged_body.h"
#include "pipeline/reports/stage_reports.h"

namespace umtet {

void take_given_edges(Parameters& parameters) {
  const char* key = keys::reconstruct::edges;
  if (parameters.cloud().features.empty() || parameters.source(key) > ParamSource::Case) return;
  parameters.set(key, "given", ParamSource::Derived, "for --features");
}

EdgedCloud edged_cloud(const OrientedPointCloud& cloud, NeighbourDistances near, const CasePaths& paths,
                       const Context& context) {
  const StageState state = inspect_stage(paths, Stage::Cloud, Json::object(), std::nullopt);
  const bool has_measured_normals = state.record && cloud_report(*state.record).normals.given;
  return edged_cloud(cloud, std::move(near), has_measured_normals, context);
}

std::string edges_text(const SharpEdges& edges) {
  std::string text =
      fmt::format("{} sharp edges, {} corners, {} patches", edges.curves.size(), edges.corners.size(), edges.n_patches);
  const std::size_t n_lines = edges.n_curves_by(SharpCurve::Reason::Line),
                    n_borders = edges.n_curves_by(SharpCurve::Reason::Border);
  if (n_lines > 0) text += fmt::format(", {} of the edges from given lines", n_lines);
  if (n_borders > 0) text += fmt::format(", {} of the edges from the file's groups", n_borders);
  return text;
}

EdgedTriangles edged_triangles(TriangleMesh mesh, const Vec3& shift, const Parameters& parameters) {
  EdgedTriangles made;
  made.shift = shift;
  made.triangles = given_triangles(std::move(mesh), shift, sharp_edge_params(parameters.reconstruct()));
  if (parameters.reconstruct().edges != SharpEdgeUse::Off) made.body = edged_body(*made.triangles);
  return made;
}

bool has_edges(const StageRecord& level_set) {
  const auto& files = level_set.outputs;
  return std::any_of(files.begin(), files.end(), [](const RecordedFile& f) { return f.name == kFeatureFile; });
}

}  // namespace umtet
