#pragma once

#include <array>

#include "mesh/core/max_min.h"
#include "mesh/core/tet_mesh.h"

namespace umtet::detail {

// A vector of the compiler: Eigen's arrays compare and select one number after the other.
using Lane = double __attribute__((vector_size(8 * kLanes)));

/// What a certificate measures of kLanes tets at once.
struct TetLanes {
  Lane quality;                              ///< mean ratio, eq. (6); -1 where that is not a number
  Lane volume6, rms_edge;                    ///< six times the signed volume; root of the mean squared edge
  Lane least_cotangent, greatest_cotangent;  ///< signed squares, of the six dihedral angles
  std::array<bool, kLanes> inverted{};       ///< exact sign of the volume <= 0
};

/// Measures tets[0 .. count - 1]; the lanes beyond repeat the last of them. What is found of a tet does not depend on
/// its lane, nor on the others. \pre 1 <= count <= kLanes
TetLanes measure_tet_lanes(const TetMesh& mesh, const Tet* tets, int count);

}  // namespace umtet::detail
