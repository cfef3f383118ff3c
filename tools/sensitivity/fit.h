#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "mesh/background/background_mesh.h"
#include "mesh/base/id_set.h"
#include "mesh/fast/fast_params.h"
#include "mesh/fast/smoothing/tangential_relaxation.h"
#include "tools/sensitivity/bodies.h"

namespace umtet::sensitivity {

/// All that is varied. FastParams holds no parameters of tangential relaxation, and no quality that costs nothing.
struct Settings {
  FastParams fast;
  TangentialRelaxationParams relaxation;
  std::optional<double> good;  ///< of StarCostTable, in place of that of the tiling
};

/// What is measured of a mesh. Percents and rates are of the mesh's own size, so that bodies count alike.
enum Measure : std::size_t {
  kFailed,       ///< 1: no mesh
  kLeft,         ///< tets that smoothing leaves below the target, in 10^5 tets with a boundary vertex
  kBelow,        ///< the same when repair is done
  kLeastQ,       ///< min Q
  kQuantile,     ///< 1 % quantile of Q over all tets
  kMisaligned,   ///< boundary faces more than 60 degrees from psi = 0, in 10^5
  kFoldedOver,   ///< more than 90 degrees
  kNotManifold,  ///< boundary vertices where the boundary is no manifold, in 10^5
  kChordal,      ///< rms of |psi| / |grad psi| at the centroids of boundary faces, 10^-3 h
  kFarthest,     ///< greatest distance from psi = 0 to the boundary of the mesh, h
  kSolves,       ///< vertex solves of projection and smoothing
  kPatches,      ///< patches that repair has shaped, in 10^5 tets with a boundary vertex
  kPsi,          ///< evaluations of psi
  kChanged,      ///< of moving bodies: vertices that change sides, in 100 positive vertices a step
  kMeasures
};
using Measured = std::array<double, kMeasures>;

struct MeasureKind {
  std::string_view name;
  bool more_is_better;
  bool in_percent;   ///< differences are, of the value with the defaults
  bool is_work;      ///< says what a mesh costs, not how good it is
  double tolerance;  ///< a smaller difference in the mean decides nothing
};
extern const std::array<MeasureKind, kMeasures> kMeasureKinds;

/// A body in its background mesh, with what does not depend on settings.
struct Subject {
  Body body;
  BackgroundMesh background;
  IdSet negative;          ///< psi < 0
  std::vector<Vec3> feet;  ///< closest points of the background vertices within an edge of psi = 0
};
Subject subject(Body body);

/// Meshes the body as fast_mesh() does, step by step.
/// @param V  if not null, receives the vertices
Measured fit(const Subject& subject, const Settings& settings, std::vector<Vec3>* V = nullptr);

/// Meshes the body, and anew each time it has moved by a quarter of a cell, three times, with FastMemory.
Measured fit_moving(const Subject& subject, const Settings& settings);

/// True if fit() ends with the vertices of fast_mesh(), to the last bit.
bool is_fast_mesh(const Subject& subject, const Settings& settings);

}  // namespace umtet::sensitivity
