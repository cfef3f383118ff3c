#pragma once

#include <vector>

#include "reconstruct/cloud/point_cloud.h"
#include "reconstruct/level_set/level_set.h"
#include "reconstruct/solve/fit_ssd.h"

namespace umtet {

/// Sets the fields of a report that describe the fitted level set: the data terms of the functional, rms_value,
/// normal_defect, n_opposed_normals and least_wall_value. No other thread may evaluate psi during the call.
/// @param area    a_i; empty for the paper's weights, which are 1
/// @param length  length scale of the weights of values, model units
void measure_fit(const OrientedPointCloud& cloud, const LevelSet& psi, const std::vector<double>& area, double length,
                 SsdReport& report);

}  // namespace umtet
