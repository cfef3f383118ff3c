#pragma once

#include <cstdint>
#include <vector>

#include "mesh/core/tet_mesh.h"

namespace umtet {

/// Known value and gradient of psi at a vertex of the background.
struct PsiValue {
  std::int64_t vertex;
  double value;
  Vec3 gradient;
};
using PsiValues = std::vector<PsiValue>;  ///< ascending by vertex

}  // namespace umtet
