#pragma once

#include <cstdint>
#include <vector>

#include "mesh/background/background_mesh.h"
#include "mesh/background/link_topology.h"
#include "mesh/base/id_set.h"

namespace umtet {

/// What is added to the id of a lattice vertex for the ids of its link, in the order of TilingTables::link. What that
/// gives in the outermost layer of cells is said at BackgroundMesh::id_step().
class LinkSteps {
 public:
  LinkSteps() = default;  ///< of no lattice
  /// Those of a lattice; any other mesh has none.
  explicit LinkSteps(const BackgroundMesh& background) : steps_(background.n_types()) {
    for (int type = 0; type < background.n_types(); ++type) {
      for (const Tiling::Corner& c : background.tiling_tables().link[type])
        steps_[type].push_back(background.id_step(type, c));
    }
  }

  /// As BackgroundMesh::type().
  int type(std::int64_t v) const { return static_cast<int>(v % static_cast<std::int64_t>(steps_.size())); }
  const std::vector<std::int64_t>& at(std::int64_t v) const { return steps_[type(v)]; }

  /// Bit k: link vertex k is inside. Inside vertices are off the background boundary, so that a step that leaves the
  /// range of ids, or leads to a wrong one in the outermost layer of cells, finds none of them.
  LinkMask mask(std::int64_t v, const IdSet& inside) const {
    LinkMask mask = 0;
    int k = 0;
    for (const std::int64_t step : at(v)) mask |= static_cast<LinkMask>(inside.test_any(v + step)) << k++;
    return mask;
  }

 private:
  std::vector<std::vector<std::int64_t>> steps_;  ///< per vertex type
};

}  // namespace umtet
