#pragma once

#include <mpi.h>

#include <cstdint>
#include <vector>

#include "distributed/distributed_mesh.h"
#include "distributed/vertex_owners.h"

namespace umtet {

/// Of the vertices of a mesh of all ranks: whether they are on the boundary, and their numbers in the whole mesh.
struct StandardData {
  VertexOwners owners;
  std::vector<std::uint8_t> boundary;    ///< of those that are owned
  std::vector<std::int64_t> number;      ///< of those that are owned
  std::vector<std::int64_t> own_number;  ///< of the vertices of the own mesh
};

/// Collective.
/// @param boundary  of the vertices of the own mesh, where it is known; null: by counting faces
StandardData standard_data(MPI_Comm comm, const DistributedMesh& mesh,
                           const std::vector<std::uint8_t>* boundary = nullptr);

/// Of the vertices of the own mesh, whether they are on the boundary of that of all ranks. Collective.
std::vector<std::uint8_t> on_boundary(MPI_Comm comm, const DistributedMesh& mesh);

/// Of vertices that are owned, where they are. Collective.
std::vector<Vec3> places_of_owned(const VertexOwners& owners, const TetMesh& mesh);

}  // namespace umtet
