#pragma once

#include <limits>

#include "mesh/background/background_mesh.h"
#include "mesh/background/tiling.h"
#include "mesh/core/implicit_function.h"

namespace umtet {

/// Method of classification: the sign of psi (Algorithm 1), or classify_vertices(), which takes fewer tets.
enum class ClassificationSource { Psi, Chosen };

/// Volume and surface area of {psi < 0}, estimated from a coarse sampling of psi.
struct BodySize {
  double volume = 0, area = 0;     ///< model units^3 and ^2; 0 if no sample is inside
  std::size_t n_not_finite = 0;    ///< samples where psi is not finite; they count as outside
  Vec3 not_finite = Vec3::Zero();  ///< position of the first of them
};

/// Estimates volume and area within 10 % if the features of the domain exceed 1/64 of the longest side of its bounding
/// box. The bounding box is first searched in `box`, so the domain must exceed 1/64 of the longest side of `box`.
/// @param steepest  an upper bound of |grad psi|, which saves samples where psi is far from zero
/// Cost: at most 2 * 65^3 values of psi; fewer with a bound. \throw std::invalid_argument for an empty box
BodySize body_size(ImplicitFunctionRef psi, const Box& box, double steepest = std::numeric_limits<double>::infinity());

/// Expected number of tets of omega_h at mean edge length h: 46 (volume + layer a area) / a^3 for an A15 of cell edge
/// a, scaled by the number of tets per volume of the tiling. The layer is Tiling::excess_layer, reduced by .15 for a
/// chosen classification. 0 if no sample is inside. \throw std::invalid_argument for h <= 0
double expected_tets(const Tiling& tiling, const BodySize& size, double h,
                     ClassificationSource source = ClassificationSource::Psi);
/// Expected number of tets for the body_size() of psi. \throw std::invalid_argument for an empty box, too
double expected_tets(const Tiling& tiling, ImplicitFunctionRef psi, const Box& box, double h);
double expected_tets(ImplicitFunctionRef psi, const Box& box, double h);  ///< expected_tets() in a lattice of A15

/// Mean edge length h at which omega_h has about n_tets tets, by the same estimate.
/// \throw std::invalid_argument for n_tets <= 0, an empty box, or if no sample is inside
double h_for_tets(const Tiling& tiling, const BodySize& size, double n_tets,
                  ClassificationSource source = ClassificationSource::Psi);
double h_for_tets(const Tiling& tiling, ImplicitFunctionRef psi, const Box& box, double n_tets);
double h_for_tets(ImplicitFunctionRef psi, const Box& box, double n_tets,
                  ClassificationSource source = ClassificationSource::Psi);  ///< h_for_tets() in A15

}  // namespace umtet
