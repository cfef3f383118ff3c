#pragma once

#include <cstddef>

#include "reconstruct/level_set/grid.h"

namespace umtet {

/// Fraction of the nodes in the six outermost layers of a grid whose value is inside.
template <class IsInside>
double wall_share(const Grid& grid, const IsInside& is_inside) {
  std::size_t n_inside = 0, n_wall = 0, at = 0;
  for (int k = 0; k < grid.n[2]; ++k) {
    const bool z = k == 0 || k + 1 == grid.n[2];
    for (int j = 0; j < grid.n[1]; ++j) {
      const bool y = z || j == 0 || j + 1 == grid.n[1];
      for (int i = 0; i < grid.n[0]; ++i, ++at) {
        if (!y && i != 0 && i + 1 != grid.n[0]) continue;
        ++n_wall;
        if (is_inside(grid.values[at])) ++n_inside;
      }
    }
  }
  return static_cast<double>(n_inside) / static_cast<double>(n_wall);
}

/// A level between the dark and the bright values of an image, with few digits: the midpoint between the means of the
/// two classes of Otsu's threshold.                                                                     [Otsu1979]
double suggested_level(const Grid& grid);

/// Converts image values v to a level set: low - v (above), v - high (below) or (v - low)(v - high) / (high - low). The
/// result is negative inside, with the slope of the image at both levels.
void take_above(Grid& grid, double low);
void take_below(Grid& grid, double high);
void take_between(Grid& grid, double low, double high);

/// Closes a body at the wall of the image, half a step beyond its outermost nodes. psi becomes max(psi, s d) on the
/// grid and on `layers` layers of nodes around it. d is the signed distance to the wall, and s is the mean change of
/// psi per unit length where it changes sign, so that psi has a similar slope there.
/// @return whether the body reaches the wall; otherwise the grid is unchanged
bool close_at_wall(Grid& grid, int layers);

}  // namespace umtet
