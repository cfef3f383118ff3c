#pragma once

#include <string>
#include <vector>

#include "mesh/guarded_projection.h"
#include "mesh/labels.h"
#include "mesh/p_norm_smooth.h"
#include "mesh/repair.h"

namespace umtet {

struct FastParams {
  int layers = 2;  ///< of vertices behind the boundary that move; >= 1. One is too few, three gain nothing: mesh_bench
  LabelParams labels;
  ProjectionParams projection;
  SmoothParams smoothing;
  /// In place of smoothing.margin, if that is greater, for a mesh that begins from the one before; >= 0. A ball that
  /// drifts a quarter cell a step: .77 of the visits of .04, for .004 of least Q and .002 of its 1 % quantile; with .025
  /// the quantile is .01 below that of meshing anew.
  double update_margin = .03;
  RepairParams repair;
};

/// Every broken constraint, not just the first.
std::vector<std::string> problems(const FastParams&);

}  // namespace umtet
