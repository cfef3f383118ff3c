#pragma once

#include <array>

#include "mesh/core/max_min.h"
#include "mesh/core/tet_mesh.h"

namespace umtet {

// A vector type of the compiler is used because Eigen's arrays compare and select element by element.
using Pack = double __attribute__((vector_size(8 * kPackSize)));

/// The values that a certificate measures, for kPackSize tets at once.
struct TetPack {
  Pack quality;                              ///< mean ratio, eq. (6); -1 where that is not a number
  Pack volume6, rms_edge;                    ///< six times the signed volume; root of the mean squared edge
  Pack least_cotangent, greatest_cotangent;  ///< signed squares, of the six dihedral angles
  std::array<bool, kPackSize> inverted{};    ///< exact sign of the volume <= 0
};

/// Measures tets[0 .. count - 1]; further elements repeat the last tet. The values of a tet depend neither on its place
/// in the pack nor on the other tets. \pre 1 <= count <= kPackSize
TetPack measure_tet_pack(const TetMesh& mesh, const Tet* tets, int count);

}  // namespace umtet
