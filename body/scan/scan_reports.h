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

// Reports of the preparation and the fit of a scan. Lengths are in model units.
namespace umtet {

/// Result of the check, by the winding number of all samples, of the normals that were made consistent between
/// neighbours. NormalsReport contains the numbers of samples.
struct WindingCheckReport {
  WindingReport::Verdict verdict = WindingReport::Verdict::Agrees;
  bool restored = false;  ///< given normals that had been turned were turned back
  /// Share of patches that bound no body (patches_off_a_half()), in [0, 1]: with the normals before the check, and with
  /// the final normals.
  double off_before = 0, off_after = 0;
  /// The same share with the normals that the winding number proposed; 0 if it proposed none.
  double off_tried = 0;
  /// consistency() of the normals before the check, and of the proposed normals; 0 if there were none.
  double consistency_before = 0, consistency_tried = 0;
  /// Residuals of fits to a part of the samples at the other samples, with the normals before the check and with the
  /// proposed normals; empty if the proposal was not certain.
  std::optional<HeldOutResidual> held_out_before, held_out_tried;
};

/// The source of the normals of a cloud, and the changes to them.
struct NormalsReport {
  bool given = false;                  ///< they came with the cloud; else they were estimated
  std::optional<std::size_t> missing;  ///< number of given normals that were zero and were estimated
  double consistency = 0;              ///< share of neighbours whose signs agree, before any change (consistency())
  /// Counts of the orientation, if it was run. After reading a record, counts that it does not contain are 0.
  std::optional<OrientationReport> orientation;
  /// Number of normals turned towards cloud.orient_from or the scanner position of the file.
  std::optional<std::size_t> turned_to_viewpoints;
  /// Numbers of normals that the winding number turned over, and of directions that it replaced; empty if it did not
  /// decide.
  std::optional<std::size_t> turned_by_winding, replaced_by_winding;
  std::optional<WindingCheckReport> winding;  ///< empty if this check was not made
};

/// Report on triangles that were sampled.
struct TrianglesReport {
  std::size_t n_vertices = 0, n_faces = 0, n_polygons = 0;  ///< numbers in the file
  TriangleReport body;
  std::size_t n_boundary = 0;            ///< number of triangles in triangles.ply
  std::vector<std::string> label_names;  ///< names of the labels 1, 2, ...: first of the file, then of the caps
  std::size_t n_labels = 0;              ///< the greatest label in the file, 0 if there are none
};

/// Report on merging: the samples of each cell became one sample (merged_samples.h).
struct MergedReport {
  std::size_t n_points = 0, n_samples = 0;  ///< numbers of samples before and after merging
  double cell = 0;                          ///< edge of a cell, model units
};

/// Report on the preparation of a scan before the fit.
struct CloudReport {
  std::string format;  ///< CloudFileReport::format
  std::size_t n_points_in_file = 0, n_normals_rescaled = 0;
  struct Dropped {
    std::size_t not_finite = 0, duplicates = 0, outliers = 0, small_components = 0;
  } dropped;  ///< numbers of points
  NormalsReport normals;
  std::optional<TrianglesReport> triangles;  ///< empty for a cloud
  std::size_t n_points = 0;                  ///< number of remaining points
  std::vector<std::string> fields = {};      ///< names of their fields (field_names())
  std::string columns = {};                  ///< CloudFileReport::columns of a text file
  std::optional<MergedReport> merged = {};   ///< empty if no samples were merged
  Eigen::AlignedBox3d box;                   ///< box of the remaining points
  std::vector<Message> notices;              ///< notices to the user about changes and guesses
};

/// Report on the fit of psi.
struct LevelSetReport {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  ///< subtracted from all coordinates before the fit
  SsdReport fit;
  double noise = 0;  ///< standard deviation of the samples along the normal that the fit assumed
  /// Correction that was added to psi (noise_bias.h); 0 if noise does not determine the spacing.
  double noise_bias = 0;
  /// 1, 5 and 50 % quantiles of the distances between opposed samples; empty if no samples face each other.
  std::optional<std::array<double, 3>> thickness;
  /// Finer lattices were omitted because the mesh could not resolve them.
  bool left_out_finer = false;
};

/// Returns the facts about normals in both reports, as shares of the points.
InputFacts input_facts(const CloudReport& cloud, const LevelSetReport& level_set);

}  // namespace umtet
