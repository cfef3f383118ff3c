#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "distributed/io/vertex_values.h"
#include "distributed/mesh/distributed_mesh.h"

namespace umtet {

/// A rank's contribution to a .vtu file with standard data: its owned nodes and its tets. Referenced lists must outlive
/// the object.
struct VtuRows {
  /// Ids of the nodes, ascending, in the order of the file. Vertices have their background ids; ids of mid-sides are
  /// greater, beginning with first_mid_side.
  const std::vector<std::int64_t>& ids;
  std::int64_t first_mid_side;
  const std::vector<Vec3>& places;            ///< positions of the nodes
  const std::vector<std::uint8_t>& boundary;  ///< boundary flags of the nodes
  /// Fields with the same names on all ranks, in ascending order, after the names of standard data.
  const VertexValues& fields;
  /// Returns the values of a field of `fields` at the nodes, consecutive. Collective.
  std::function<std::vector<double>(std::size_t field)> values;
  const DistributedMesh& mesh;  ///< contains the tets
  std::size_t nodes_per_tet;    ///< 4, or 10 for ten-node tets
  /// Returns the number in the whole mesh of node k of tet t.
  std::function<std::int64_t(std::size_t t, std::size_t k)> node;
};

/// Writes one file by all ranks, with MPI-IO: each rank receives pieces of consecutive nodes and tets in turn, and
/// writes them at their positions. Collective. \throw KnownToAll naming the file, which is then not a valid mesh
void write_ordered_vtu(MPI_Comm comm, const std::filesystem::path& file, const VtuRows& rows);

}  // namespace umtet
