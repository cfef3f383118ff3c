#pragma once

#include <cstdint>
#include <vector>

#include "mesh/core/tet_mesh.h"

namespace umtet {

/// psi and its gradient at a vertex of the background, where they have been evaluated already.
struct PsiValue {
  std::int64_t vertex;
  double value;
  Vec3 gradient;
};
using PsiValues = std::vector<PsiValue>;  ///< ascending vertices

}  // namespace umtet
