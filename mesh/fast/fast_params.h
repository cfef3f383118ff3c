#pragma once

#include <string>
#include <vector>

#include "mesh/classification/classification.h"
#include "mesh/fast/backtracking_projection.h"
#include "mesh/fast/p_norm_smoothing.h"
#include "mesh/fast/repair.h"

namespace umtet {

/// docs/constants.md has what other values do.
struct FastParams {
  /// Layers of vertices behind the boundary that move; >= 1. In a stored mesh all do, but for domains that move.
  int layers = 2;
  ClassificationParams classification;
  ProjectionParams projection;
  SmoothingParams smoothing;
  /// In place of smoothing.margin, if that is greater, for a mesh that begins from the one before; >= 0. Less takes
  /// fewer solves, and lowers the 1 % quantile of Q.
  double update_margin = .033;
  RepairParams repair;
  /// Outside of lattices: no repair(), because flip_submesh() follows.
  bool flips_follow = false;

  /// The mean ratio that every tet is to reach in the end, on lattices of A15 and Z.
  double quality_target() const { return repair.target + repair.lift; }
  /// Makes `quality` that. In (repair.lift, 1); more than the default takes more time, and not all tets may reach it.
  void set_quality_target(double quality) { smoothing.target = repair.target = quality - repair.lift; }
};

/// Every broken constraint, not just the first.
std::vector<std::string> problems(const FastParams&);

}  // namespace umtet
