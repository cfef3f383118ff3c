#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "body/scan/scan_reports.h"
#include "pipeline/case/record.h"
#include "pipeline/reports/certificate_report.h"

// The results of the stages: `numbers` of their records. Lengths are in model units. Only the functions below name the
// results in JSON.
namespace umtet {

/// The report of 3-mesh.
struct MeshReport {
  double conditioning_angle_max_deg = 0;
  std::size_t n_psi_evaluations = 0;
  MeshMeasures measured;
};

Json to_json(const TrianglesReport& report);
/// @param wanted  wanted_mesh(): stored in the document if samples were merged, or lattices left out, for that mesh
Json to_json(const CloudReport& report, const Json& wanted);
Json to_json(const LevelSetReport& report, const Json& wanted);
Json to_json(const MeshReport& report);

/// Returns the report in the record of the stage. \throw ArtefactDamaged  a value is missing
CloudReport cloud_report(const StageRecord& record);
LevelSetReport level_set_report(const StageRecord& record);
MeshReport mesh_report(const StageRecord& record);
/// Returns wanted_mesh() of the mesh for which 1-cloud or 2-level-set left out detail; none if they left out none.
/// \throw ArtefactDamaged  a value is missing
std::optional<Json> wanted_of(const StageRecord& record);

/// Returns the names of labels 1, 2 ... in the file of triangles from which a case is made; none for a cloud or a
/// formula.
std::vector<std::string> label_names_of_file(const CasePaths& paths);

}  // namespace umtet
