#pragma once

#include <string>
#include <vector>

#include "mesh/classification/classification.h"
#include "mesh/fast/projection/backtracking_projection.h"
#include "mesh/fast/repair/repair.h"
#include "mesh/fast/smoothing/p_norm_smoothing.h"

namespace umtet {

/// Parameters of fast_mesh(). docs/constants.md lists the effect of other values.
struct FastParams {
  /// Layers of vertices behind the boundary that move; >= 1. In a stored mesh all vertices move, except for moving
  /// domains.
  int layers = 2;
  ClassificationParams classification;
  ProjectionParams projection;
  SmoothingParams smoothing;
  /// Replaces smoothing.margin, if greater, for a mesh that begins from the previous one; >= 0. A smaller value needs
  /// fewer solves and lowers the 1 % quantile of Q.
  double update_margin = .033;
  RepairParams repair;
  /// Outside of lattices: no repair(), because flip_submesh() follows.
  bool flips_follow = false;

  /// The mean ratio that every tet should reach in the end, on the lattices A15 and Z.
  double quality_target() const { return repair.target + repair.lift; }
  /// Sets the quality target; in (repair.lift, 1). A value above the default takes more time, and some tets may not
  /// reach it.
  void set_quality_target(double quality) { smoothing.target = repair.target = quality - repair.lift; }
};

/// All broken constraints, not just the first.
std::vector<std::string> problems(const FastParams&);

}  // namespace umtet
