#pragma once

#include <mpi.h>

#include "distributed/io/curved_files.h"
#include "distributed/io/part_files.h"
#include "distributed/mesh/distributed_mesh.h"
#include "pipeline/meshing/part_mesher.h"

namespace umtet {

/// Sends the boundary data of vertices from rank 0 to the ranks with positive faces at them. Collective.
/// @param data  used on rank 0 only
VertexValues shared_values(MPI_Comm comm, const DistributedMesh& mesh, const BoundaryData& data);

/// Sends the data of mid-sides on the boundary from rank 0 to their owners. On rank 0, the mid-sides are in the order
/// of their owning ranks. Collective.
/// @param edges      edges of this rank, indices into PartEdges::owned()
/// @param n_of_rank  number of edges per rank, on rank 0
MidSideValues shared_mid_side_values(MPI_Comm comm, const std::vector<std::size_t>& edges,
                                     const std::vector<std::size_t>& n_of_rank, const BoundaryData& data);

/// Data of pieces besides standard data: patches, which ranks request from rank 0, and values of vertices.
/// @param data  used on rank 0 only, where it must outlive the use of the result
PieceExtras piece_extras(MPI_Comm comm, const DistributedMesh& mesh, const PieceData& data);

}  // namespace umtet
