#include "pipeline/domain/load_domain.h"

#include <algorithm>
#include <utility>

#include "body/edges/edged_body.h"
#include "body/edges/edged_cloud.h"
#include "body/given_triangles.h"
#include "body/option_names.h"
#include "body/piecewise_body.h"
#include "body/scan/fitted_domain.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/domain/handover.h"
#include "pipeline/reports/stage_reports.h"
#include "reconstruct/io/level_set_io.h"
#include "reconstruct/io/point_cloud_io.h"
#include "reconstruct/io/triangle_mesh_io.h"

namespace umtet {

namespace {

/// Reads the level set of a case; its file contains the same bits as the level set that was written.
LevelSet level_set_of(const std::filesystem::path& file) {
  try {
    return read_level_set(file);
  } catch (const LevelSetRefused& e) {  // umtet wrote the file, so an error in it is damage
    throw ArtefactDamaged(e.what());
  }
}

/// Returns the level shift of the mesh of the case.
double level_shift_of(const CasePaths& paths) {
  const StageState state = inspect_stage(paths, Stage::Mesh, Json::object(), std::nullopt);
  return state.record ? mesh_report(*state.record).measured.domain.level_shift : 0;
}

bool is_of_triangles(const CasePaths& paths, const StageRecord& cloud) {
  const std::vector<RecordedFile>& outputs = cloud.outputs;
  const std::string name = paths.triangles().filename().string();
  return std::any_of(outputs.begin(), outputs.end(), [&](const RecordedFile& f) { return f.name == name; });
}

/// Triangles with sharp edges: a function for each smooth patch.
Domain domain_with_edges(const CasePaths& paths, const Parameters& parameters, const LevelSetReport& report,
                         Handover* handover) {
  EdgedTriangles edged = handover && handover->edged.body
                             ? std::exchange(handover->edged, {})
                             : edged_triangles(read_triangles(paths.triangles()).mesh, report.shift, parameters);
  if (!edged.body) throw ArtefactDamaged(paths.triangles().string() + ": has no sharp edges");
  OrientedPointCloud cloud = handover && handover->cloud ? std::move(*std::exchange(handover->cloud, std::nullopt))
                                                         : read_point_cloud(paths.cloud()).cloud;
  Domain domain = edged_domain(std::move(edged.triangles), std::move(edged.body), std::move(cloud), report.shift,
                               parse_box(parameters.mesh().box), parameters.mesh().h);
  domain.cloud_spacing = report.fit.cloud_spacing;
  return domain;
}

/// A cloud with sharp edges: a function for each smooth patch.
Domain cloud_with_edges(const CasePaths& paths, const Parameters& parameters, Handover* handover) {
  OrientedPointCloud cloud = handover && handover->cloud ? std::move(*std::exchange(handover->cloud, std::nullopt))
                                                         : read_point_cloud(paths.cloud()).cloud;
  const EdgedCloud edged = handover && handover->edged_cloud ? *std::exchange(handover->edged_cloud, std::nullopt)
                                                             : edged_cloud(cloud, {}, paths, until_interrupted());
  if (!edged.body) throw ArtefactDamaged(paths.cloud().string() + ": has no sharp edges");
  return edged_domain(edged, std::move(cloud), parse_box(parameters.mesh().box), parameters.mesh().h);
}

}  // namespace

Domain formula_domain(const Parameters& parameters, std::optional<double> t) {
  const std::optional<Box> box = parse_box(parameters.mesh().box);
  if (!box) throw UsageError({Option{keys::mesh::implicit}, " needs ", Setting(option::box, "x0,y0,z0,x1,y1,z1")});
  Domain domain;
  set_formula(domain, parameters.mesh().implicit, t);
  domain.box = *box;
  domain.diagonal = box->diagonal().norm();
  domain.complement = parameters.mesh().complement;
  return domain;
}

Domain load_domain(const CasePaths& paths, const Parameters& parameters, Handover* handover) {
  if (!parameters.mesh().level_set.empty()) return grid_domain(parameters);
  if (!parameters.mesh().implicit.empty()) return formula_domain(parameters);
  const StageState state = inspect_stage(paths, Stage::LevelSet, parameters.section("reconstruct"), std::nullopt);
  if (!state.record) throw ArtefactDamaged(state.reason);
  Domain domain;
  try {
    if (has_edges(*state.record)) {
      const LevelSetReport report = level_set_report(*state.record);
      const StageState cloud = inspect_stage(paths, Stage::Cloud, Json::object(), std::nullopt);
      domain = cloud.record && is_of_triangles(paths, *cloud.record)
                   ? domain_with_edges(paths, parameters, report, handover)
                   : cloud_with_edges(paths, parameters, handover);
      if (cloud.record) domain.facts = input_facts(cloud_report(*cloud.record), report);
      domain.complement = parameters.mesh().complement;
      return domain;
    }
    LevelSet psi = handover && handover->psi ? std::move(*std::exchange(handover->psi, std::nullopt))
                                             : level_set_of(paths.level_set());
    OrientedPointCloud cloud = handover && handover->cloud ? std::move(*std::exchange(handover->cloud, std::nullopt))
                                                           : read_point_cloud(paths.cloud()).cloud;
    const LevelSetReport report = level_set_report(*state.record);
    domain = fitted_domain(std::move(psi), std::move(cloud), report, parse_box(parameters.mesh().box));
    const StageState cloud_state = inspect_stage(paths, Stage::Cloud, Json::object(), std::nullopt);
    if (cloud_state.record) domain.facts = input_facts(cloud_report(*cloud_state.record), report);
    domain.fitted = FittedLevelSet(*domain.level_set, [file = paths.level_set()] { return level_set_of(file); });
    if (handover && handover->triangles) {
      domain.triangles = given_triangles(std::move(*std::exchange(handover->triangles, std::nullopt)), domain.shift,
                                         sharp_edge_params(parameters.reconstruct()));
    } else if (cloud_state.record && is_of_triangles(paths, *cloud_state.record)) {
      domain.triangles = given_triangles(read_triangles(paths.triangles()).mesh, domain.shift,
                                         sharp_edge_params(parameters.reconstruct()));
    }
    if (domain.triangles) domain.level_shift = level_shift_of(paths);
  } catch (const CloudRefused& e) {  // umtet wrote all files, so an error in them is damage
    throw ArtefactDamaged(e.what());
  }
  domain.complement = parameters.mesh().complement;
  return domain;
}

}  // namespace umtet
