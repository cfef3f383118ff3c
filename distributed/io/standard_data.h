#pragma once

#include <mpi.h>

#include <cstdint>
#include <vector>

#include "distributed/mesh/distributed_mesh.h"
#include "distributed/mesh/vertex_owners.h"

namespace umtet {

/// Standard data of the vertices of a distributed mesh: whether they are on the boundary, and their numbers in the
/// whole mesh.
struct StandardData {
  VertexOwners owners;
  std::vector<std::uint8_t> boundary;    ///< boundary flags of the owned vertices
  std::vector<std::int64_t> number;      ///< numbers of the owned vertices in the whole mesh
  std::vector<std::int64_t> own_number;  ///< numbers of the local vertices in the whole mesh
};

/// Computes standard data. Collective.
/// @param boundary  boundary flags of the local vertices, if they are known; null: they are computed by counting faces
StandardData standard_data(MPI_Comm comm, const DistributedMesh& mesh,
                           const std::vector<std::uint8_t>* boundary = nullptr);

/// Returns for each local vertex whether it is on the boundary of the whole mesh. Collective.
std::vector<std::uint8_t> on_boundary(MPI_Comm comm, const DistributedMesh& mesh);

/// Returns the positions of the owned vertices. Collective.
std::vector<Vec3> places_of_owned(const VertexOwners& owners, const TetMesh& mesh);

}  // namespace umtet
