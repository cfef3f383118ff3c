#pragma once

#include <mpi.h>

#include "distributed/distributed_mesh.h"
#include "distributed/io/curved_files.h"
#include "distributed/io/part_files.h"
#include "pipeline/meshing/part_mesher.h"

namespace umtet {

/// What rank 0 knows of vertices of the boundary, on the ranks that have positive faces with them. Collective.
/// @param data  read on rank 0
VertexValues shared_values(MPI_Comm comm, const DistributedMesh& mesh, const BoundaryData& data);

/// The same of mid-sides on the boundary: those that each rank owns, one rank after the other.
/// @param edges      of this rank, places in PartEdges::owned()
/// @param n_of_rank  how many each has, on rank 0
MidSideValues shared_mid_side_values(MPI_Comm comm, const std::vector<std::size_t>& edges,
                                     const std::vector<std::size_t>& n_of_rank, const BoundaryData& data);

/// What pieces hold besides standard data: patches, which ranks ask rank 0 for, and values of vertices.
/// @param data  read on rank 0, where it stays while the result is used
PieceExtras piece_extras(MPI_Comm comm, const DistributedMesh& mesh, const PieceData& data);

}  // namespace umtet
