#pragma once

#include <array>
#include <string>
#include <vector>

#include "mesh/background/tiling.h"
#include "mesh/core/tet_mesh.h"

namespace umtet {

/// A tiling from all tets of a period, each perhaps several times and moved by periods.
///
/// Corners are in coordinates in which the symmetry of the tiling is exact, so that the same point reached in two ways
/// has the same bits: multiples of 1/2, or a table's numbers with their signs and places changed. A tet goes to the
/// cell that holds its barycentre; vertex types are in (z, y, x) order, tets in that of their corners.
/// @param period  of the tiling along x, y, z, in those coordinates
/// @param unit    tiling units of one unit of each coordinate
/// \throw std::invalid_argument for a tet that reaches beyond the cells next to its own, or has no volume
Tiling periodic_tiling(std::string name, const std::vector<std::array<Vec3, 4>>& tets, const Vec3& period,
                       const Vec3& unit);

}  // namespace umtet
