#pragma once

#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "distributed/distributed_mesh.h"
#include "distributed/io/part_files.h"
#include "distributed/part_edges.h"
#include "distributed/part_second_order.h"

// Files of tets of second order that all ranks have. All functions are collective.
namespace umtet {

/// What a rank has of them.
struct CurvedPiece {
  const DistributedMesh& mesh;  ///< with the places of the file
  const PartEdges& edges;
  const CurvedParts& curved;
  Vec3 shift;  ///< that takes mid-sides there
};

/// Point data of mid-sides on the boundary, of the edges that a rank owns. All ranks have the same arrays, those of the
/// VertexValues beside it.
struct MidSideValues {
  std::vector<std::size_t> edges;           ///< places in PartEdges::owned(), ascending
  std::vector<std::vector<double>> arrays;  ///< by edge, as many components as VertexValues has
};

/// write_whole_vtu() of second order, as write_vtu() has it.
/// @param boundary  of the vertices of the own mesh
/// \throw KnownToAll naming the file; what is there then is no mesh
void write_whole_vtu(MPI_Comm comm, const std::filesystem::path& file, const CurvedPiece& piece,
                     const std::vector<std::uint8_t>& boundary, const VertexValues& of_vertices,
                     const MidSideValues& of_mid_sides);

/// write_pvtu() of second order: `global_vertex` and `owner` are of nodes, which are corners and then mid-sides.
/// \throw KnownToAll naming a file
std::vector<std::filesystem::path> write_curved_pvtu(MPI_Comm comm, const std::filesystem::path& pvtu,
                                                     const CurvedPiece& piece, const PieceExtras& extras = {},
                                                     const MidSideValues& of_mid_sides = {});

}  // namespace umtet
