#pragma once

#include <cstdint>
#include <vector>

#include "mesh/background/background_mesh.h"
#include "mesh/background/link_topology.h"
#include "mesh/base/id_set.h"

namespace umtet {

/// Id differences from a lattice vertex to the vertices of its link, in the order of TilingTables::link.
/// BackgroundMesh::id_step() describes the results in the outermost layer of cells.
class LinkSteps {
 public:
  LinkSteps() = default;  ///< makes an object without a lattice
  /// Differences for a lattice; empty for any other mesh.
  explicit LinkSteps(const BackgroundMesh& background) : steps_(background.n_types()) {
    for (int type = 0; type < background.n_types(); ++type) {
      for (const Tiling::Corner& c : background.tiling_tables().link[type])
        steps_[type].push_back(background.id_step(type, c));
    }
  }

  /// Returns the type of a lattice vertex, like BackgroundMesh::type().
  int type(std::int64_t v) const { return static_cast<int>(v % static_cast<std::int64_t>(steps_.size())); }
  const std::vector<std::int64_t>& at(std::int64_t v) const { return steps_[type(v)]; }

  /// Bit k is set if link vertex k is inside. Inside vertices are off the background boundary, so a step that leaves
  /// the range of ids, or leads to a wrong id in the outermost layer of cells, does not find an inside vertex.
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
