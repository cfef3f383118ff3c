#pragma once

#include <string>
#include <vector>

#include "mesh/classification/classification.h"
#include "mesh/fast/backtracking_projection.h"
#include "mesh/fast/p_norm_smoothing.h"
#include "mesh/fast/repair.h"

namespace umtet {

struct FastParams {
  int layers = 2;  ///< of vertices behind the boundary that move; >= 1. One is too few, three gain nothing: mesh_bench
  ClassificationParams classification;
  ProjectionParams projection;
  SmoothingParams smoothing;
  /// In place of smoothing.margin, if that is greater, for a mesh that begins from the one before; >= 0. A ball that
  /// drifts a quarter cell a step: .85 of the solves of .04, and 1 % quantiles of Q within .004 of meshing anew. With
  /// .03 it is .77 and .006, and .01 on a ball of 5k tets.
  double update_margin = .033;
  RepairParams repair;

  /// Makes `quality` the mean ratio that every tet is to reach, in place of kQualityTarget; in (0, 1)
  void set_quality_target(double quality) { smoothing.target = repair.target = quality; }
};

/// Every broken constraint, not just the first.
std::vector<std::string> problems(const FastParams&);

}  // namespace umtet
