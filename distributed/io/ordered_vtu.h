#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "distributed/distributed_mesh.h"
#include "distributed/io/vertex_values.h"

namespace umtet {

/// What a rank has of a .vtu with standard data: the nodes that it owns, and its tets. Lists stay where they are.
struct VtuRows {
  /// Of nodes, ascending, in the order of the file. Vertices have those of the background; those of mid-sides are
  /// greater, from first_mid_side on.
  const std::vector<std::int64_t>& ids;
  std::int64_t first_mid_side;
  const std::vector<Vec3>& places;            ///< of nodes
  const std::vector<std::uint8_t>& boundary;  ///< of nodes
  const VertexValues& fields;  ///< what they are, of all ranks: ascending by name, behind the names of standard data
  /// Of the nodes the numbers of this array of `fields`, one after the other. Collective.
  std::function<std::vector<double>(std::size_t field)> values;
  const DistributedMesh& mesh;  ///< with its tets
  std::size_t nodes_per_tet;    ///< 4, or 10 of second order
  /// The number in the whole mesh of node k of tet t.
  std::function<std::int64_t(std::size_t t, std::size_t k)> node;
};

/// The file of all ranks, by MPI-IO: each has pieces of consecutive nodes and tets in turn, and writes them where they
/// belong. Collective. \throw KnownToAll naming the file; what is there then is no mesh
void write_ordered_vtu(MPI_Comm comm, const std::filesystem::path& file, const VtuRows& rows);

}  // namespace umtet
