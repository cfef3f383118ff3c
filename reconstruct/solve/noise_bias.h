#pragma once

#include "reconstruct/cloud/point_cloud.h"
#include "reconstruct/level_set/level_set.h"

namespace umtet {

/// How far noise moves a curved surface. Samples that are off by sigma in all directions lie, on average, outside of a
/// convex place, sigma^2 H off it: H = 1/2 div(grad psi / |grad psi|) is its mean curvature, 1 / r on a sphere. A body
/// that is fitted to them is larger by sigma^2 times the integral of H over its surface.
/// @param noise  sigma, standard deviation of the samples along each axis, model units
/// @return sigma^2 times the mean of H at the samples, where grad psi tells it; no curvature counts that is greater
/// than
///         1 / h, h the spacing of psi; model units
double noise_bias(const LevelSet& psi, const OrientedPointCloud& cloud, double noise);

/// psi + c: its functions sum to one.
LevelSet shifted(const LevelSet& psi, double c);

}  // namespace umtet
