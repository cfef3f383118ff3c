#pragma once

#include <functional>
#include <vector>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/sizes/source_tree.h"

namespace umtet {

/// User-defined edge lengths in a box, model units.
struct SizeFunction {
  std::function<double(const Vec3&)> h;  ///< thread-safe; a result that is not a number means no requirement there
  Box box;
};

/// The points where f, clamped to [h_min, h_max], begins to rise by more than `grade` per unit length. As sources,
/// together with f, they define a field with this Lipschitz constant.
///
/// f is sampled on 64 cubes along the longer side of its box. Cubes at the lower ends of its steep regions are halved
/// while they are wider than half the least f at their corners. Steep detail smaller than a 64th of the box may be
/// missed.
/// \pre grade > 0, 0 < h_min <= h_max
/// \throw std::invalid_argument for an empty box; Cancelled
/// Cost: 3e5 values of f, and about 30 per halved cube. The result does not depend on the number of threads.
std::vector<SizeSource> steep_ends(const SizeFunction& f, double grade, double h_min, double h_max,
                                   const Context& context = {});

}  // namespace umtet
