#pragma once

#include <optional>
#include <string>
#include <vector>

#include "body/fidelity/mesh_measures.h"

// The third judgement: whether a mesh fits the input. It is a function of the result of measure().
namespace umtet {

/// The ways in which a mesh can differ from a cloud, triangles or labels. The end of each comment gives the amount that
/// InputDefect::amount states, and its unit.
enum class InputDefectKind {
  Missed,    ///< samples are farther than h from the mesh; largest distance, in h
  Guessed,   ///< parts of the boundary have no sample near them; their share of the area
  Handles,   ///< no sample supports some handles of the boundary; number of these handles
  Pieces,    ///< no sample supports some pieces of the boundary, or the number of pieces is wrong; number of pieces
  Distance,  ///< the triangles and the boundary are farther than h apart; largest distance, in h
  /// The volume differs from the input; relative difference, for triangles minus the part that flat faces explain.
  Volume,
  Genus,  ///< the number of handles differs from the triangles; difference
  /// Centres of voxels are more than half a voxel on the wrong side of the boundary; share of the body's voxels.
  Voxels,
  Edges,  ///< sharp edges of the triangles are rounded; largest distance from one to the boundary, in h
  Noise,  ///< the noise of the samples hides finer features; its standard deviation, in h
  Sides,  ///< the outward side of samples is a guess; their share
};

/// Returns the word that documents and VerdictOptions::accept use: "missed", "guessed", "handles", "pieces",
/// "distance", "volume", "genus", "voxels", "edges", "noise", "sides".
const char* to_string(InputDefectKind kind);

/// A difference between a mesh and its input.
struct InputDefect {
  InputDefectKind kind;
  double amount = 0;
  bool is_small = false;  ///< the mesh passes, and the verdict names the defect
  std::string what;       ///< one clause with the amount and the position
};

/// The boundary is a guess where no sample is near, and the outward side of a sample may be one. If the share of
/// guesses exceeds this value, the verdict names a defect ...
inline constexpr double kMuchGuessed = .2;
/// ... and above this value, at which most of the boundary is a guess, the mesh fails.
inline constexpr double kMostlyGuessed = .5;
/// Distances of missed samples above kDeeplyMissed h are not noise. If also more than the share kFewMissed of all
/// samples is missed, the mesh fails. Outliers that remain after cleaning are fewer.
inline constexpr double kDeeplyMissed = 3, kFewMissed = .01;
/// Noise, in h, from which the verdict names a defect. By default h is at least noise / kMostNoise.
inline constexpr double kMuchNoise = .25;
/// Single noisy samples can be at any distance from the mesh; fewer than this number are not a defect.
inline constexpr std::size_t kFewestBeyondH = 10;
/// Relative differences between the volumes of mesh and triangles, beyond the part that flat faces explain: above the
/// first the verdict names a defect, above the second the mesh fails.
inline constexpr double kVolumeNamed = .005, kVolumeFails = .02;
/// The same limits for voxels, whose volume is less certain: a layer of .02 voxels on a ball of six voxels is 1 %.
inline constexpr double kVoxelsNamed = .01, kVoxelsFail = .03;
/// Rounded edges are a defect from this share of the length of all edges on.
inline constexpr double kFewRounded = .02;
/// If more than this share of voxels is on the wrong side, noise is not the reason, and the mesh fails.
inline constexpr double kFewChanged = .01;

/// Returns all differences between the mesh and the cloud, the triangles or the labels, in the order of
/// InputDefectKind; none for a formula, because it is psi itself.
std::vector<InputDefect> input_defects(const MeshMeasures& measured);

}  // namespace umtet
