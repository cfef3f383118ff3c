#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/base/id_set.h"
#include "mesh/core/implicit_function.h"
#include "mesh/submesh/linked_active_layer.h"

namespace umtet {

/// A tet of a layer that repair() has to improve.
struct BadTet {
  double badness;  ///< Q; if its face is misaligned, the cosine of the face minus 1, which is below 0: folded over
                   ///< faces are the worst
  std::array<std::int64_t, 4> tet;
};

/// The tets of a layer with a mean ratio below a target or a misaligned face (patch_state.h), in the order of the
/// layer.
/// @param n_evaluations  is increased by the number of evaluations of psi
std::vector<BadTet> bad_tets(const BackgroundLayer& layer, const IdSet& inside, ImplicitFunctionRef psi, double target,
                             std::size_t& n_evaluations);

}  // namespace umtet
