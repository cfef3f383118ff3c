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

/// Tags of elements, and of nodes with data, are 32 bits wide. \throw std::invalid_argument for so many
inline void require_msh_tags(std::size_t n) {
  if (n > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
    throw std::invalid_argument("a .msh file of more than 2^31 elements, or of nodes with data");
}

/// A field of a .msh of Gmsh, 2.2 or 4.1.
struct MshNodeData {
  const std::string& name;
  const FieldValues& values;                ///< by node
  std::span<const std::int64_t> node = {};  ///< their numbers from 0, of these and perhaps more; empty: 0 1 2 ...
  int part = 0;                             ///< from 1, of a file in parts; 0: of a whole mesh
};

/// Writes $NodeData. \throw std::invalid_argument as require_msh_tags(). Nodes without a value, NaN, are there, too:
/// meshio wants all nodes, in their order.
void write_node_data(CheckedFile& file, const MshNodeData& data, bool is_binary);

}  // namespace umtet
