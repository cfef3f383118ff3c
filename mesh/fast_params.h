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
  RepairParams repair;
};

/// Every broken constraint, not just the first.
std::vector<std::string> problems(const FastParams&);

}  // namespace umtet
