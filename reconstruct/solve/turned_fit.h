#pragma once

#include "reconstruct/solve/fit_ssd.h"

namespace umtet {

/// Share of normals that may point against grad psi. Noise and sharp edges oppose single ones; a tenth means that a
/// patch of them is turned over.
inline constexpr double kMostOpposed = .1;

/// Share of the samples with n_i . grad psi(x_i) < 0.
double opposed_share(const SsdReport& report);

/// fit_ssd(); while more than kMostOpposed of the normals are opposed, these are turned over and psi is fitted again,
/// up to four times, as long as each fit opposes fewer [iterated as in Hou2022]. Clouds with fewer pay nothing.
/// @param cloud  its normals are those of the psi that is returned
/// Throws as fit_ssd.
SsdFit fit_turning_opposed(OrientedPointCloud& cloud, const SsdParams& params = {}, const Context& context = {},
                           const NeighbourDistances* near = nullptr);

}  // namespace umtet
