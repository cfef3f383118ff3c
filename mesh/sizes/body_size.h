#pragma once

#include <limits>

#include "mesh/background/background_mesh.h"
#include "mesh/background/tiling.h"
#include "mesh/core/implicit_function.h"

namespace umtet {

/// Who says which vertices are inside: the sign of psi (Algorithm 1), or classify_vertices(), by which fewer tets are
/// taken.
enum class ClassificationSource { Psi, Chosen };

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

/// About how many tets omega_h will have at mean edge length h: 46 (volume + layer a area) / a^3 for an A15 of cell
/// edge a, and as much more or less as the tiling has tets a volume; layer is Tiling::excess_layer, .15 less with
/// a chosen classification. 0 when no sample lies inside. \throw std::invalid_argument for h <= 0
double expected_tets(const Tiling& tiling, const BodySize& size, double h,
                     ClassificationSource source = ClassificationSource::Psi);
/// With body_size() of psi. \throw std::invalid_argument for an empty box, too
double expected_tets(const Tiling& tiling, ImplicitFunctionRef psi, const Box& box, double h);
double expected_tets(ImplicitFunctionRef psi, const Box& box, double h);  ///< for A15

/// A mean edge length h at which omega_h has about n_tets tets, by the same count.
/// \throw std::invalid_argument for n_tets <= 0, an empty box, or when no sample lies inside
double h_for_tets(const Tiling& tiling, const BodySize& size, double n_tets,
                  ClassificationSource source = ClassificationSource::Psi);
double h_for_tets(const Tiling& tiling, ImplicitFunctionRef psi, const Box& box, double n_tets);
double h_for_tets(ImplicitFunctionRef psi, const Box& box, double n_tets,
                  ClassificationSource source = ClassificationSource::Psi);  ///< for A15

}  // namespace umtet
