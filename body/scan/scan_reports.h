#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "body/input_facts.h"
#include "common/message.h"
#include "reconstruct/cloud/normals/normal_orientation.h"
#include "reconstruct/solve/fit_ssd.h"
#include "reconstruct/solve/held_out.h"
#include "reconstruct/triangles/body_samples.h"
#include "reconstruct/winding/orient_by_winding.h"

// What preparation and fit of a scan find out. Lengths in model units.
namespace umtet {

/// What the winding number of all samples said of the normals that neighbours agreed on, and how sure it was. The
/// numbers of samples stand in NormalsReport.
struct WindingCheckReport {
  WindingReport::Verdict verdict = WindingReport::Verdict::Agrees;
  bool restored = false;                 ///< given normals that had been turned were turned back
  double off_before = 0, off_after = 0;  ///< share of patches that bound no body (patches_off_a_half), in [0, 1]: of
                                         ///< the normals as they were, and as they are left
  double off_tried = 0;                  ///< of the normals that the winding number proposed; 0 where it proposed none
  double consistency_before = 0, consistency_tried = 0;  ///< of both; 0 where it proposed none
  /// How well fits to a part of the samples explain others, with both; none where it was not certain.
  std::optional<HeldOutResidual> held_out_before, held_out_tried;
};

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
  std::optional<WindingCheckReport> winding;  ///< none where it was not asked
};

/// Of triangles that were sampled.
struct TrianglesReport {
  std::size_t n_vertices = 0, n_faces = 0, n_polygons = 0;  ///< as the file counts them
  TriangleReport body;
  std::size_t n_boundary = 0;            ///< of triangles.ply
  std::vector<std::string> label_names;  ///< of label 1, 2 ..., as the file has them, and those of caps
  std::size_t n_labels = 0;              ///< the greatest of the file, 0 without
};

/// Samples that became one a cell (merged_samples.h).
struct MergedReport {
  std::size_t n_points = 0, n_samples = 0;  ///< before and after
  double cell = 0;                          ///< its edge, model units
};

/// What was done to a scan before the fit.
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
  std::vector<Message> notices;              ///< what was changed or guessed, for the user
};

/// The fit of psi.
struct LevelSetReport {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  ///< taken off all coordinates before the fit
  SsdReport fit;
  double noise = 0;       ///< of the samples along the normal, as the fit took it
  double noise_bias = 0;  ///< that was added to psi (noise_bias.h); 0 where noise does not decide its spacing
  std::optional<std::array<double, 3>> thickness;  ///< 1, 5 and 50 % of the distances between opposed samples; none
                                                   ///< where none face one another
  bool left_out_finer = false;                     ///< lattices that the mesh would not show
};

/// What both say about normals, as shares of the points.
InputFacts input_facts(const CloudReport& cloud, const LevelSetReport& level_set);

}  // namespace umtet
