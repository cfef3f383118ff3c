#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "distributed/io/vertex_values.h"
#include "distributed/mesh/distributed_mesh.h"
#include "distributed/solver/solver_part.h"
#include "mesh/io/solver_mesh.h"
#include "mesh/io/tet_mesh_io.h"

// Files of distributed meshes, written without gathering them. Positions are those of the file. All functions are
// collective.
namespace umtet {

/// Writes the file that write_vtu() makes of the whole mesh with_standard_data(), byte for byte, by MPI-IO. Each rank
/// receives pieces of consecutive vertices and tets in turn, and writes them at their positions.
/// @param boundary  boundary flags of the local vertices; null: they are computed from the tets
/// @param more      additional arrays, with ascending names after the names of standard data
/// \pre all ranks have a common file system
/// \throw KnownToAll naming the file, which is then not a valid mesh
void write_whole_vtu(MPI_Comm comm, const std::filesystem::path& file, const DistributedMesh& mesh,
                     const std::vector<std::uint8_t>* boundary = nullptr, const VertexValues& more = {});

/// Extracts some tets with their vertices. \pre `tets` is ascending
DistributedMesh some_of(const DistributedMesh& mesh, const std::vector<std::size_t>& tets);

/// Data of pieces besides standard data.
struct PieceExtras {
  std::vector<MeshPart> patches;  ///< patches of the boundary; empty: the patches of SolverPart, with numbers from 2
  int body_number = 1;
  /// Maps numbers of faces in the whole mesh to indices into `patches`. Collective; null if there are no patches.
  std::function<std::vector<int>(const std::vector<std::int64_t>& global_face)> patch_of;
  VertexValues values;  ///< point data of a .pvtu file, boundary data of a .msh file
};

/// Writes the local tets of each rank as a piece, NAME_RANK.vtu, and a NAME.pvtu file that lists the pieces with tets.
/// Besides the standard data, vertices have `global_vertex` and tets `global_tet`, their numbers in the whole mesh.
/// Vertices also have `owner`, the first rank that has them, and 0/1 arrays with the names of the patches, except for a
/// patch that is the whole boundary.
/// @return the files, the same on all ranks, the .pvtu last
/// \throw KnownToAll naming a file
std::vector<std::filesystem::path> write_pvtu(MPI_Comm comm, const std::filesystem::path& pvtu,
                                              const DistributedMesh& mesh, const PieceExtras& extras = {});

/// Writes the NAME.pvtu file for pieces that write() writes.
/// @param has_piece  whether this rank has a piece
/// @param point_data, cell_data  data of the local piece; all ranks have the same arrays
/// @param write      writes the local piece
std::vector<std::filesystem::path> write_pvtu(MPI_Comm comm, const std::filesystem::path& pvtu, bool has_piece,
                                              const std::map<std::string, FieldValues>& point_data,
                                              const std::map<std::string, FieldValues>& cell_data,
                                              const std::function<void(const std::filesystem::path&)>& write);

/// Writes a file of write_msh41_piece() for each rank with tets, NAME_1.msh ..., with its ghost tets.
/// @return the files, the same on all ranks
/// \throw KnownToAll naming a file
std::vector<std::filesystem::path> write_msh_pieces(MPI_Comm comm, const std::filesystem::path& msh,
                                                    const DistributedMesh& mesh, const PieceExtras& extras = {});

/// Assigns the faces of a part to the patches of `extras`, if there are any. Collective. @return the patches
std::vector<MeshPart> divide_part(SolverPart& part, const PieceExtras& extras);

}  // namespace umtet
