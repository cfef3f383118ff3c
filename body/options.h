#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mesh/background/background_mesh.h"
#include "mesh/sizes/source_tree.h"
#include "mesh/universal_mesh.h"
#include "reconstruct/solve/fit_ssd.h"
#include "reconstruct/triangles/sharp_edges.h"

// The options of this library. The table of the program, pipeline/case/parameters.def, gives the fields of ScanOptions,
// FitOptions, MeshOptions and VerdictOptions their flags and ranges; the ranges are checked there.
namespace umtet {

/// The source of the normals of a scan.
enum class NormalsOf {
  Auto,     ///< the normals of the scan, after a reversed minority is turned over; missing normals are estimated
  Given,    ///< the normals of the scan, unchanged
  Estimate  ///< all normals are estimated
};

/// The use of the sharp edges of triangles and clouds.
enum class SharpEdgeUse {
  Auto,  ///< each smooth patch has a function of its own, and the mesh has the edges
  Off,   ///< one smooth level set, which rounds the edges
  Given  ///< as Auto, but edges are the lines of the triangles and the borders of their labels only
};

enum class WindingCheck {
  Auto,  ///< the winding number of all samples overrules estimated and turned normals if it is certain
  Off
};

/// Options for the preparation of a scan before the fit.
struct ScanOptions {
  bool keep_all = false;  ///< keeps outliers and small pieces far from the rest
  NormalsOf normals = NormalsOf::Auto;
  WindingCheck winding = WindingCheck::Auto;
  /// Merges samples that are denser than the mesh can resolve, if there are at least 200,000 points.
  bool merge = true;
  bool flip = false;  ///< turns all normals over at the end
};

/// Options for the fit of psi to the samples. SsdParams documents the fields without a comment.
struct FitOptions {
  double spacing = SsdParams().spacing;
  double smoothing = SsdParams().smoothing;
  double noise = -1;  ///< standard deviation of the samples along the normal, model units; -1: measured
  double detail = SsdParams().detail;
  double smooth = SsdParams().smooth;
  double alpha = SsdParams().alpha;
  SsdWeights weights = SsdParams().weights;
  LmePrior::Kind prior = LmePrior().kind;
  double gamma = LmePrior().gamma;
  std::int64_t support = LmePrior().support;
  double epsilon = LmePrior().epsilon;
  std::optional<SsdSolver> solver = {};  ///< empty: Multilevel, or Full if the weights or the prior require it
  Closing close = SsdParams().closing;
  SharpEdgeUse edges = SharpEdgeUse::Auto;
  double feature_angle = SharpEdgeParams().sure_turn;
  double tolerance = SsdParams().tolerance;
  double band_tolerance = SsdParams().band_tolerance;
  std::int64_t max_iterations = SsdParams().max_iterations;
  std::int64_t padding = SsdParams().padding;
};

/// The rule by which edges of triangles are sharp.
inline SharpEdgeParams sharp_edge_params(const FitOptions& fit) {
  return {.sure_turn = fit.feature_angle,
          .by_turn = fit.edges != SharpEdgeUse::Given,
          .by_user = fit.edges != SharpEdgeUse::Off};
}

/// Options for the mesh: edge lengths and method. Lengths are in model units; with 0 the library chooses the value.
struct MeshOptions {
  double h = 0;              ///< edge length of the background mesh
  std::int64_t tets = 0;     ///< approximate number of tets, instead of h
  double max_deviation = 0;  ///< largest distance of flat faces from psi = 0, instead of h
  /// Maximum number of tets, unless `tets` is larger; 2 million take about a minute and 1 GB.
  std::int64_t max_tets = 2'000'000;
  /// Limits the total number of tets of all attempts, as a multiple of the tets of the first attempt; >= 1.
  double effort = 2.5;
  /// "auto", "graded", one of tiling_names(), or any other name: then BodyOptions::background makes the mesh.
  std::string background = "auto";
  double grade = .3;  ///< growth of edge lengths per unit length (graded)
  double h_min = 0;   ///< least edge length (graded); 0: the larger of h / 16 and the least that noise allows
  /// Largest edge length (graded); 0: h on the boundary, in the interior only `grade` limits it.
  double h_max = 0;
  /// Largest angle in degrees by which the surface may turn along an edge (graded); 0: no limit.
  double max_turn = 52;
  /// Distance from the boundary, in edge lengths, at which edge lengths start to grow (graded).
  double constant_layer = 2;
  bool grade_inside = false;  ///< keeps h on the whole boundary (graded)
  bool box_walls = false;     ///< fills the box up to flat walls
  bool complement = false;    ///< meshes {psi > 0} up to the walls of the box
  UmMode mode = UmMode::Fast;
  std::int64_t order = 1;  ///< order of the tets, 1 or 2; with 2 the mid-side nodes of boundary edges are on psi = 0
  double target_quality = FastParams().quality_target();
  bool flips = true;  ///< local flips improve the tets if the background is not a lattice (flipped_submesh.h)
  std::int64_t projection_passes = PaperParams().projection_passes;
  std::int64_t relaxation_iterations = PaperParams().relaxation_iterations;
  std::int64_t samples = PaperParams().samples;
  DirectionRule directions = PaperParams().directions;
  ClosestPointMethod closest_point = ClosestPointParams().method;
  MaxMin max_min = PaperParams().max_min;
  std::int64_t seed = static_cast<std::int64_t>(PaperParams().seed);
  bool keep_iterates = PaperParams().keep_iterates;
};

/// Additional requirements of the verdict, besides validity and fidelity.
struct VerdictOptions {
  double min_quality = 0;   ///< least mean ratio that passes; 0: no limit
  bool strict = false;      ///< small defects fail as well
  std::string accept = {};  ///< kinds of defects that pass, in the format of parse_accepted_defects()
};

/// Edge lengths that depend on position, from points or from a function. They require a graded background.
struct GivenSizes {
  std::vector<SizeSource> sources = {};  ///< model coordinates
  /// Edge length at x, model coordinates; empty if there is no function.
  std::function<double(const Vec3& x)> function = {};
  std::string name = {};  ///< name of the function in messages
};

/// Edge lengths for the labels of the cloud. They require a graded background.
struct LabelSizes {
  std::map<int, double> factors = {};  ///< factors of h by label, in (0, 1]
  std::string name = {};               ///< name of the list in messages
};

/// All options for making a mesh from a scan or from psi.
struct BodyOptions {
  ScanOptions scan = {};
  FitOptions fit = {};
  MeshOptions mesh = {};
  /// Returns the positions of the scanners; normals are turned towards the nearest one. It is called when needed, and
  /// may throw. Empty: the positions are unknown.
  std::function<std::vector<Vec3>()> viewpoints = {};
  /// Makes the background mesh if `mesh.background` is not a name of the library. Its coordinates are model coordinates
  /// minus `shift`. May throw.
  std::function<BackgroundMesh(const Vec3& shift)> background = {};
  /// Returns the edge lengths of the caller. It is called when needed, and may throw. Empty: the caller gives none.
  std::function<GivenSizes()> sizes = {};
  std::function<LabelSizes()> label_sizes = {};  ///< like `sizes`, for labels
  /// The caller has set `mesh.grade`, which requires a graded background.
  bool grade_is_given = false;
  /// The caller has set `mesh.max_turn`, which requires a graded background. Otherwise the default limit makes no edges
  /// shorter than h / 2, or finer than the noise of the samples allows.
  bool max_turn_is_given = false;
  double max_memory = 0;  ///< bytes of memory that the fit may use; 0: no limit
};

/// \throw UsageError with every broken constraint
SsdParams ssd_params(const FitOptions& options);

/// \throw UsageError with every broken constraint
UmParams um_params(const MeshOptions& options);

}  // namespace umtet
