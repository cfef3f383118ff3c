#pragma once

#include <cstdint>
#include <vector>

#include "mesh/core/tet_mesh.h"

namespace umtet {

/// psi at vertices of the background, where it has been evaluated already.
struct PsiValue {
  std::int64_t vertex;
  double value;
  Vec3 gradient;
};
using PsiValues = std::vector<PsiValue>;  ///< ascending vertices

}  // namespace umtet
