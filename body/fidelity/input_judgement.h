#pragma once

#include <optional>
#include <string>
#include <vector>

#include "body/fidelity/mesh_measures.h"

// The third judgement: whether a mesh fits what was given. It is a function of what measure() found out.
namespace umtet {

/// A way in which a mesh can differ from a cloud, triangles or labels. `amount` of an InputDefect is in the unit below.
enum class InputDefectKind {
  Missed,    ///< samples are farther than h from the mesh; largest distance, h
  Guessed,   ///< no sample is near the boundary; share of its area
  Handles,   ///< handles of the boundary that no sample supports; count
  Pieces,    ///< pieces of the boundary that no sample supports, or another number than the triangles have; count
  Distance,  ///< triangles and boundary are farther than h from each other; largest distance, h
  Volume,    ///< not the given volume; relative difference, of triangles less what flat faces explain
  Genus,     ///< another number of handles than the triangles have; difference
  Voxels,    ///< centres of voxels are on the other side of the boundary, farther than half a voxel; share of all
  Noise,     ///< the noise of the samples hides what is finer; its standard deviation, h
};

/// As documents and VerdictOptions::accept have it: "missed", "guessed", "handles", "pieces", "distance", "volume", "genus",
/// "voxels", "noise".
const char* to_string(InputDefectKind kind);
std::optional<InputDefectKind> input_defect_kind_of(const std::string& word);

/// One difference between a mesh and what was given.
struct InputDefect {
  InputDefectKind kind;
  double amount = 0;
  bool is_small = false;  ///< the mesh passes, and the defect is named
  std::string what;       ///< one clause with its number and its place
};

/// A boundary is a guess where no sample is near; beyond this share of it a mesh is no plain pass ...
inline constexpr double kMuchGuessed = .2;
/// ... and beyond this one, where most of it is invented, none at all.
inline constexpr double kMostlyGuessed = .5;
/// Missed samples as deep as this, in h, are no noise of the mesh: where they are more than kFewMissed of all samples
/// the mesh fails. Outliers that cleaning has left are fewer.
inline constexpr double kDeeplyMissed = 3, kFewMissed = .01;
/// Noise, in h, from which a mesh is no plain pass. By default h is at least the noise over kMostNoise.
inline constexpr double kMuchNoise = .25;
/// Single samples of noise are off by any distance; fewer than these are no defect.
inline constexpr std::size_t kFewestBeyondH = 10;
/// Relative differences of volume from triangles, beyond what flat faces explain: named, and failing.
inline constexpr double kVolumeNamed = .005, kVolumeFails = .02;
/// The same from voxels, which know their volume less well: a layer of .02 voxels on a ball of six is 1 %.
inline constexpr double kVoxelsNamed = .01, kVoxelsFail = .03;
/// More than this share of voxels on the other side is no accident of noise.
inline constexpr double kFewChanged = .01;

/// All differences between the mesh and the cloud, the triangles or the labels, in the order of InputDefectKind; empty
/// for a formula, which is its own psi.
std::vector<InputDefect> input_defects(const MeshMeasures& measured);

}  // namespace umtet
