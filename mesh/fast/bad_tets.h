#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/base/id_set.h"
#include "mesh/core/implicit_function.h"
#include "mesh/submesh/linked_active_layer.h"

namespace umtet {

/// A tet of a layer that repair() has to look at.
struct BadTet {
  double badness;  ///< Q; below 0, the cosine of its face less 1, if that is misaligned: folded over ones are the worst
  std::array<std::int64_t, 4> tet;
};

/// The tets of a layer that are below a mean ratio or have a misaligned face (patch_state.h), in its order.
/// @param n_evaluations  is raised by the number of values of psi
std::vector<BadTet> bad_tets(const BackgroundLayer& layer, const IdSet& inside, ImplicitFunctionRef psi, double target,
                             std::size_t& n_evaluations);

}  // namespace umtet
