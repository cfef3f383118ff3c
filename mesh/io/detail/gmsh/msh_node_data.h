#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>

#include "mesh/io/checked_file.h"
#include "mesh/io/tet_mesh_io.h"

namespace umtet {

/// Checks a number of elements, or of nodes with data, whose tags have 32 bits. \throw std::invalid_argument for too
/// many
inline void require_msh_tags(std::size_t n) {
  if (n > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
    throw std::invalid_argument("a .msh file of more than 2^31 elements, or of nodes with data");
}

/// A node field for a Gmsh .msh file, 2.2 or 4.1.
struct MshNodeData {
  const std::string& name;
  const FieldValues& values;                ///< values by node
  std::span<const std::int64_t> node = {};  ///< node numbers from 0, one per value and perhaps more; empty: 0 1 2 ...
  int part = 0;                             ///< part number from 1 in a partitioned file; 0: a whole mesh
};

/// Writes $NodeData. Nodes without a value (NaN) are included, because meshio requires all nodes in order.
/// \throw std::invalid_argument under the conditions of require_msh_tags()
void write_node_data(CheckedFile& file, const MshNodeData& data, bool is_binary);

}  // namespace umtet
