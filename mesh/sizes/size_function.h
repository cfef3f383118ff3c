#pragma once

#include <functional>
#include <vector>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/sizes/source_tree.h"

namespace umtet {

/// Edge lengths that somebody asks for in a box, model units.
struct SizeFunction {
  std::function<double(const Vec3&)> h;  ///< thread-safe; no number: no wish there
  Box box;
};

/// Where f, clamped to [h_min, h_max], begins to rise by more than `grade` a length: as sources these are what a field
/// of that Lipschitz constant needs beside f itself.
///
/// f is sampled on 64 cubes along the longer side of its box. Cubes at the lower ends of its steep places are halved
/// while they are wider than half the least f at their corners. Steep detail smaller than a 64th of the box may be
/// missed.
/// \pre grade > 0, 0 < h_min <= h_max \throw std::invalid_argument  an empty box; Cancelled
/// Cost: 3e5 values of f, and some 30 a cube that is halved. The result does not depend on the number of threads.
std::vector<SizeSource> steep_ends(const SizeFunction& f, double grade, double h_min, double h_max,
                                   const Context& context = {});

}  // namespace umtet
