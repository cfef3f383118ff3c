#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/case/record.h"
#include "pipeline/reports/certificate_report.h"
#include "reconstruct/cloud/normal_orientation.h"
#include "reconstruct/solve/fit_ssd.h"
#include "reconstruct/triangles/body_samples.h"

// What the stages find out: `numbers` of their records. Lengths in model units. The functions below are the only place
// where these have names in JSON.
namespace umtet {

/// Where the normals of a cloud are from, and what was done to them.
struct NormalsReport {
  bool given = false;                  ///< they came with the cloud; else they were estimated
  std::optional<std::size_t> missing;  ///< of given ones: zero normals, which were estimated
  double consistency = 0;              ///< share of neighbours whose signs agree, as they came; see consistency()
  /// Of normals that were turned where need be: its counts. Read back, what the record does not have is 0.
  std::optional<OrientationReport> orientation;
  std::optional<std::size_t> turned_to_viewpoints;  ///< by cloud.orient_from, or the scanner position of the file
  /// By the winding number, where it decided: normals that look to the other side, directions that it gave.
  std::optional<std::size_t> turned_by_winding, replaced_by_winding;
};

/// Of triangles that were sampled.
struct TrianglesReport {
  std::size_t n_vertices = 0, n_faces = 0, n_polygons = 0;  ///< as the file counts them
  TriangleReport body;
  std::size_t n_boundary = 0;            ///< of triangles.ply
  std::vector<std::string> label_names;  ///< of label 1, 2 ..., as the file has them
};

/// Samples that became one a cell (merged_samples.h).
struct MergedReport {
  std::size_t n_points = 0, n_samples = 0;  ///< before and after
  double cell = 0;                          ///< its edge, model units
  Json wanted;                              ///< what mesh they were merged for: wanted_mesh()
};

/// Of 1-cloud.
struct CloudReport {
  std::string format;  ///< of the file, as CloudFileReport has it
  std::size_t n_points_in_file = 0, n_normals_rescaled = 0;
  struct Dropped {
    std::size_t not_finite = 0, duplicates = 0, outliers = 0, small_components = 0;
  } dropped;  ///< points
  NormalsReport normals;
  std::optional<TrianglesReport> triangles;  ///< none of a cloud
  std::size_t n_points = 0;                  ///< that are left
  std::vector<std::string> fields = {};      ///< what they carry: field_names()
  std::string columns = {};                  ///< of a text: CloudFileReport::columns
  std::optional<MergedReport> merged = {};   ///< none where samples are what they were
  Eigen::AlignedBox3d box;                   ///< of them
  std::vector<std::string> notices;          ///< what was changed or guessed, for the user
};

/// Of 2-level-set.
struct LevelSetReport {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  ///< taken off all coordinates before the fit
  SsdReport fit;
  double noise = 0;                                ///< of the samples along the normal, as the fit took it
  std::optional<std::array<double, 3>> thickness;  ///< 1, 5 and 50 % of the distances between opposed samples; none
                                                   ///< where none face one another
  std::optional<Json> wanted = {};  ///< wanted_mesh(), where finer lattices were left out because it shows none
};

/// Of 3-mesh.
struct MeshReport {
  double conditioning_angle_max_deg = 0;
  std::size_t n_psi_evaluations = 0;
  MeshMeasures measured;
};

Json to_json(const TrianglesReport& report);
Json to_json(const CloudReport& report);
Json to_json(const LevelSetReport& report);
Json to_json(const MeshReport& report);

/// What the record of that stage holds. \throw ArtefactDamaged  something is missing
CloudReport cloud_report(const StageRecord& record);
LevelSetReport level_set_report(const StageRecord& record);
MeshReport mesh_report(const StageRecord& record);

/// Names of label 1, 2 ... in the file of triangles that a case is made from; none of a cloud or a formula.
std::vector<std::string> label_names_of_file(const CasePaths& paths);

}  // namespace umtet
