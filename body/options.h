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

// The options of this library. The table of the program, pipeline/case/parameters.def, gives the fields of ScanOptions,
// FitOptions, MeshOptions and VerdictOptions their flags and ranges; the ranges are checked there.
namespace umtet {

/// Which normals of a scan are used.
enum class NormalsOf {
  Auto,     ///< those of the scan, with a turned minority turned back; estimated ones where there are none
  Given,    ///< those of the scan, as they are
  Estimate  ///< estimated ones
};

enum class WindingCheck {
  Auto,  ///< the winding number of all samples overrules estimated and turned normals where it is certain
  Off
};

/// How a scan is prepared for the fit.
struct ScanOptions {
  bool keep_all = false;  ///< keeps outliers and small pieces far from the rest
  NormalsOf normals = NormalsOf::Auto;
  WindingCheck winding = WindingCheck::Auto;
  bool merge = true;  ///< merges samples that are denser than the mesh can show, from 200,000 points on
  bool flip = false;  ///< turns all normals over at the end
};

/// How psi is fitted to the samples. Fields without a comment are those of SsdParams.
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
  std::optional<SsdSolver> solver = {};  ///< none: Multilevel, or Full where the weights or the prior need it
  Closing close = SsdParams().closing;
  double tolerance = SsdParams().tolerance;
  double band_tolerance = SsdParams().band_tolerance;
  std::int64_t max_iterations = SsdParams().max_iterations;
  std::int64_t padding = SsdParams().padding;
};

/// How fine a body is meshed, and how. Lengths are in model units; 0 leaves a choice to the library.
struct MeshOptions {
  double h = 0;                       ///< edge length of the background mesh
  std::int64_t tets = 0;              ///< number of tets to aim at, instead of h
  double max_deviation = 0;           ///< largest distance of flat faces from psi = 0, instead of h
  std::int64_t max_tets = 2'000'000;  ///< most tets, unless `tets` is larger: about a minute and 1 GB
  double effort = 2.5;  ///< all attempts together have at most this many times the tets of the first; >= 1
  /// "auto", "graded", one of tiling_names(), or any other name: then BodyOptions::background makes the mesh.
  std::string background = "auto";
  double grade = .3;          ///< growth of edge lengths per unit length (graded)
  double h_min = 0;           ///< least edge length (graded); 0: h / 16, and what noise allows
  double h_max = 0;           ///< largest edge length (graded); 0: h on the boundary, as `grade` allows inside
  double max_turn = 52;       ///< degrees by which the surface may turn along an edge (graded); 0: any
  double constant_layer = 2;  ///< edge lengths start to grow at this many of them from the boundary (graded)
  bool grade_inside = false;  ///< keeps h on the whole boundary (graded)
  bool box_walls = false;     ///< fills the box up to flat walls
  bool complement = false;    ///< meshes {psi > 0} up to the walls of the box
  UmMode mode = UmMode::Fast;
  std::int64_t order = 1;  ///< of the tets, 1 or 2; with 2 the mid-sides of boundary edges are on psi = 0
  double target_quality = FastParams().quality_target();
  bool flips = true;  ///< local flips raise the tets of a mesh whose background is no lattice (flipped_submesh.h)
  std::int64_t projection_passes = PaperParams().projection_passes;
  std::int64_t relaxation_iterations = PaperParams().relaxation_iterations;
  std::int64_t samples = PaperParams().samples;
  DirectionRule directions = PaperParams().directions;
  ClosestPointMethod closest_point = ClosestPointParams().method;
  MaxMin max_min = PaperParams().max_min;
  std::int64_t seed = static_cast<std::int64_t>(PaperParams().seed);
  bool keep_iterates = PaperParams().keep_iterates;
};

/// What a mesh has to pass besides being valid and faithful.
struct VerdictOptions {
  double min_quality = 0;   ///< least mean ratio that passes; 0: any
  bool strict = false;      ///< small defects fail, too
  std::string accept = {};  ///< kinds of defects that pass, as parse_accepted_defects() reads them
};

/// Edge lengths by place, from points or from a function. They ask for a graded background.
struct GivenSizes {
  std::vector<SizeSource> sources = {};                ///< model coordinates
  std::function<double(const Vec3& x)> function = {};  ///< of model coordinates; empty: none
  std::string name = {};                               ///< of the function, for messages
};

/// Edge lengths by label of the cloud. They ask for a graded background.
struct LabelSizes {
  std::map<int, double> factors = {};  ///< of h, in (0, 1]
  std::string name = {};               ///< of the list, for messages
};

/// All options for the way from a scan or a psi to a mesh.
struct BodyOptions {
  ScanOptions scan = {};
  FitOptions fit = {};
  MeshOptions mesh = {};
  /// Where scanners stood: normals look to the nearest. Called when it is needed, and may throw; empty: unknown.
  std::function<std::vector<Vec3>()> viewpoints = {};
  /// Makes the background mesh, in coordinates from which `shift` has been taken off, where `mesh.background` is not a
  /// name of the library. May throw.
  std::function<BackgroundMesh(const Vec3& shift)> background = {};
  /// Edge lengths that the caller gives. Called when they are needed, and may throw; empty: none are given.
  std::function<GivenSizes()> sizes = {};
  std::function<LabelSizes()> label_sizes = {};  ///< the same by label
  bool grade_is_given = false;                   ///< the caller has chosen `mesh.grade`: asks for a graded background
  bool max_turn_is_given = false;  ///< the same of `mesh.max_turn`, which then holds within the noise, too
  double max_memory = 0;           ///< bytes that the fit may take; 0: no limit
};

/// \throw UsageError with every broken constraint
SsdParams ssd_params(const FitOptions& options);

/// \throw UsageError with every broken constraint
UmParams um_params(const MeshOptions& options);

}  // namespace umtet
