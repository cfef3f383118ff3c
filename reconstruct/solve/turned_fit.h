#pragma once

#include "reconstruct/solve/fit_ssd.h"

namespace umtet {

/// Maximum fraction of normals that may point against grad psi. Noise and sharp edges oppose single normals; a tenth
/// indicates that a patch of them is turned over.
inline constexpr double kMostOpposed = .1;

/// Fraction of the samples with n_i . grad psi(x_i) < 0.
double opposed_share(const SsdReport& report);

/// Repeats fit_ssd(), turning normals: while more than kMostOpposed of the normals are opposed to grad psi, these are
/// turned over and psi is fitted again, up to four times, as long as each fit opposes fewer [iterated as in Hou2022].
/// Clouds with fewer opposed normals have no extra cost.
/// @param cloud  receives the normals of the returned psi
/// Throws the exceptions of fit_ssd().
SsdFit fit_turning_opposed(OrientedPointCloud& cloud, const SsdParams& params = {}, const Context& context = {},
                           const NeighbourDistances* near = nullptr);

}  // namespace umtet
