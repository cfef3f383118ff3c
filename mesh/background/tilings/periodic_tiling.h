#pragma once

#include <array>
#include <string>
#include <vector>

#include "mesh/background/tiling.h"
#include "mesh/core/tet_mesh.h"

namespace umtet {

/// Makes a tiling from all tets of a period; tets may be repeated and shifted by periods.
///
/// Corners are in coordinates in which the symmetry of the tiling is exact, so that a point reached in two ways has the
/// same bits: multiples of 1/2, or the numbers of a table with signs and axes permuted. A tet is assigned to the cell
/// that contains its barycentre. Vertex types are in (z, y, x) order, tets in the order of their corners.
/// @param period  period of the tiling along x, y, z, in these coordinates
/// @param unit    tiling units per unit of each coordinate
/// \throw std::invalid_argument for a tet that reaches beyond the cells next to its own, or has no volume
Tiling periodic_tiling(std::string name, const std::vector<std::array<Vec3, 4>>& tets, const Vec3& period,
                       const Vec3& unit);

}  // namespace umtet
