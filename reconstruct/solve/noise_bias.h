#pragma once

#include "reconstruct/cloud/point_cloud.h"
#include "reconstruct/level_set/level_set.h"

namespace umtet {

/// Bias of a curved surface by noise. Samples with noise sigma in all directions lie, on average, outside of a convex
/// surface, at a distance of sigma^2 H. H = 1/2 div(grad psi / |grad psi|) is the mean curvature, 1 / r on a sphere. A
/// body fitted to such samples is too large by sigma^2 times the integral of H over its surface.
/// @param noise  sigma, standard deviation of the samples along each axis, model units
/// @return sigma^2 times the mean of H at the samples where grad psi determines it; curvatures are limited to 1 / h,
///         with h the spacing of psi; model units
double noise_bias(const LevelSet& psi, const OrientedPointCloud& cloud, double noise);

/// psi + c, by adding c to all coefficients, because the functions sum to one.
LevelSet shifted(const LevelSet& psi, double c);

}  // namespace umtet
