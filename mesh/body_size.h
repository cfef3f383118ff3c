#pragma once

#include <limits>

#include "mesh/background_mesh.h"
#include "mesh/implicit_function.h"
#include "mesh/tiling.h"

namespace umtet {

/// Volume and area of the boundary of {psi < 0}, read off a coarse sampling of psi.
struct BodySize {
  double volume = 0, area = 0;     ///< model units^3 and ^2; 0 when no sample lies inside
  std::size_t n_not_finite = 0;    ///< samples where psi is no finite number; they count as outside
  Vec3 not_finite = Vec3::Zero();  ///< the place of the first of them
};

/// Within 10 % when the features of the domain exceed 1/64 of the longest side of its own box; that is looked for in
/// `box` first, so the domain must exceed 1/64 of the longest side of `box` there.
/// @param steepest  a bound of |grad psi|: where psi is far from zero, samples beside need not be taken
/// Cost: at most 2 * 65^3 values of psi; fewer with a bound. \throw std::invalid_argument for an empty box
BodySize body_size(ImplicitFunctionRef psi, const Box& box, double steepest = std::numeric_limits<double>::infinity());

/// expected_tets() and h_for_tets() of mesh/submesh.h for a size that is known.
double expected_tets(const Tiling& tiling, const BodySize& size, double h);
double h_for_tets(const Tiling& tiling, const BodySize& size, double n_tets);

}  // namespace umtet
