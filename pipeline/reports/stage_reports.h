#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "body/scan/scan_reports.h"
#include "pipeline/case/record.h"
#include "pipeline/reports/certificate_report.h"

// What the stages find out: `numbers` of their records. Lengths in model units. The functions below are the only place
// where these have names in JSON.
namespace umtet {

/// Of 3-mesh.
struct MeshReport {
  double conditioning_angle_max_deg = 0;
  std::size_t n_psi_evaluations = 0;
  MeshMeasures measured;
};

Json to_json(const TrianglesReport& report);
/// @param wanted  wanted_mesh(): stands in the document where samples were merged, or lattices left out, for that mesh
Json to_json(const CloudReport& report, const Json& wanted);
Json to_json(const LevelSetReport& report, const Json& wanted);
Json to_json(const MeshReport& report);

/// What the record of that stage holds. \throw ArtefactDamaged  something is missing
CloudReport cloud_report(const StageRecord& record);
LevelSetReport level_set_report(const StageRecord& record);
MeshReport mesh_report(const StageRecord& record);
/// wanted_mesh() of the mesh that 1-cloud or 2-level-set left detail out for; none where they left out none.
/// \throw ArtefactDamaged  something is missing
std::optional<Json> wanted_of(const StageRecord& record);

/// Names of label 1, 2 ... in the file of triangles that a case is made from; none of a cloud or a formula.
std::vector<std::string> label_names_of_file(const CasePaths& paths);

}  // namespace umtet
