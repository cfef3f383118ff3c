#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "common/vec3.h"
#include "mesh/background/vertex_links.h"
#include "mesh/base/id_set.h"

namespace umtet {

/// State that one mesh passes to the mesh of the next psi in the same background.
struct FastMemory {
  IdSet negative{0};                                 ///< vertices with psi < 0
  IdSet inside{0};                                   ///< vertices classified as inside
  std::vector<std::pair<std::int64_t, Vec3>> moved;  ///< vertices off their background positions, ascending
  std::size_t n_recalled = 0;  ///< the number of moved vertices that began at their position in the last mesh
  std::shared_ptr<const VertexLinks> links;  ///< links of the background
};

}  // namespace umtet
