#pragma once

#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "distributed/io/part_files.h"
#include "distributed/mesh/distributed_mesh.h"
#include "distributed/second_order/part_edges.h"
#include "distributed/second_order/part_second_order.h"

// Files of distributed ten-node tets. All functions are collective.
namespace umtet {

/// Ten-node tets of a rank for a file.
struct CurvedPiece {
  const DistributedMesh& mesh;  ///< local mesh with the positions of the file
  const PartEdges& edges;
  const CurvedParts& curved;
  Vec3 shift;  ///< translation of mid-sides to these positions
};

/// Point data of mid-sides on the boundary, for the edges that a rank owns. All ranks have the same arrays, which are
/// those of the corresponding VertexValues.
struct MidSideValues {
  std::vector<std::size_t> edges;           ///< indices into PartEdges::owned(), ascending
  std::vector<std::vector<double>> arrays;  ///< values per edge, with the number of components in VertexValues
};

/// Writes ten-node tets like write_whole_vtu(), in the format of write_vtu().
/// @param boundary  boundary flags of the local vertices
/// \throw KnownToAll naming the file, which is then not a valid mesh
void write_whole_vtu(MPI_Comm comm, const std::filesystem::path& file, const CurvedPiece& piece,
                     const std::vector<std::uint8_t>& boundary, const VertexValues& of_vertices,
                     const MidSideValues& of_mid_sides);

/// Writes ten-node tets like write_pvtu(). `global_vertex` and `owner` refer to nodes: corners, followed by mid-sides.
/// \throw KnownToAll naming a file
std::vector<std::filesystem::path> write_curved_pvtu(MPI_Comm comm, const std::filesystem::path& pvtu,
                                                     const CurvedPiece& piece, const PieceExtras& extras = {},
                                                     const MidSideValues& of_mid_sides = {});

}  // namespace umtet
