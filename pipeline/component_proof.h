#pragma once

#include <cstddef>
#include <vector>

#include "mesh/zero_set.h"
#include "reconstruct/level_set.h"

namespace umtet {

/// What the sign bounds of a level set say about a count of its pieces on a grid.
struct ComponentProof {
  std::vector<Vec3> unseen;  ///< a point near each piece of psi = 0 that the count has missed: smaller than its grid
  std::size_t n_open = 0;    ///< places where the bounds leave open whether psi is zero; 0: the list is complete
};

/// Looks for pieces of psi = 0 that a count does not know. Every zero lies in one of sign_cells(); a group of touching
/// cells without a point of a counted piece either holds a piece of its own, or none: then finer cells say so.
/// @param box   of the count
/// @param size  edge of the first cells; h / 2 is cheap. A piece that touches the cells of a counted one is taken for
///              part of it.
ComponentProof prove_components(const LevelSet& psi, const Eigen::AlignedBox3d& box, const ZeroSetTopology& counted,
                                double size);

}  // namespace umtet
