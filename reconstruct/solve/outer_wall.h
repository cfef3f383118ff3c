#pragma once

#include <vector>

#include "reconstruct/level_set/level_set.h"
#include "reconstruct/solve/ssd_sample.h"

namespace umtet {

/// Least psi at 16 x 16 places on each of the six walls of its domain, model units. Below 0 the set psi < 0 reaches the
/// wall and bounds no body. Nobody else may evaluate psi meanwhile.
double least_wall_value(const LevelSet& psi);

/// Samples at the centres of the outermost cells of a lattice: psi is the distance to the nearest sample of the surface
/// there, in lattice spacings. Far from its samples the minimiser of the Hessian energy is nearly linear, so it may
/// become negative beyond the end of a long tube; these samples require that the wall is outside. Their weight, 1e-3 of
/// a sample of the surface, matters only where no other sample determines psi.
/// @param surface  samples in units of the lattice; not empty
std::vector<SsdSample> wall_samples(const Lattice& lattice, const std::vector<SsdSample>& surface);

}  // namespace umtet
