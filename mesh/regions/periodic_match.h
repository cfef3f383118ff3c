#pragma once

#include <cstddef>
#include <vector>

#include "mesh/core/tet_mesh.h"
#include "mesh/regions/periodic_mesh.h"

namespace umtet {

/// How the sides of a periodic mesh fit together.
struct PeriodicMatch {
  std::size_t n_pairs = 0;
  double farthest = 0;  ///< largest distance of a copy from its place, model units
  /// Boundary faces whose copy is a boundary face, too, with the opposite orientation: corners ascending in each, and
  /// the list ascending.
  std::vector<Triangle> sides;
  std::size_t n_unmatched = 0;  ///< boundary faces without such a copy: the surfaces of bodies without an outside
};

/// Compares the sides of a periodic mesh, from the tets and the pairs alone.
PeriodicMatch match_sides(const PeriodicMesh& mesh);

}  // namespace umtet
