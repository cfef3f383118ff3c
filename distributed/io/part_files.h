#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "distributed/distributed_mesh.h"
#include "distributed/io/vertex_values.h"
#include "distributed/solver_part.h"
#include "mesh/io/solver_mesh.h"
#include "mesh/io/tet_mesh_io.h"

// Files of what all ranks have, without a gather. Places are those of the file. All functions are collective.
namespace umtet {

/// What write_vtu() writes of the whole mesh with_standard_data(), byte for byte, by MPI-IO: each rank has pieces of
/// consecutive vertices and tets in turn, and writes them where they belong.
/// @param boundary  of the vertices of the own mesh, where it is another than that of its tets
/// @param more      names are greater than those of standard data, and ascending
/// \pre all ranks see one file system. \throw KnownToAll naming the file; what is there then is no mesh
void write_whole_vtu(MPI_Comm comm, const std::filesystem::path& file, const DistributedMesh& mesh,
                     const std::vector<std::uint8_t>* boundary = nullptr, const VertexValues& more = {});

/// Some tets with their vertices. \pre ascending
DistributedMesh some_of(const DistributedMesh& mesh, const std::vector<std::size_t>& tets);

/// What pieces hold besides standard data.
struct PieceExtras {
  std::vector<MeshPart> patches;  ///< of the boundary; empty: those of SolverPart, numbers from 2 on
  int body_number = 1;
  /// Of faces by their numbers among those of all ranks, indices into `patches`. Collective; null without patches.
  std::function<std::vector<int>(const std::vector<std::int64_t>& global_face)> patch_of;
  VertexValues values;  ///< point data of a .pvtu, boundary data of a .msh
};

/// Each rank its own tets as a piece, NAME_RANK.vtu, and a NAME.pvtu that lists those with tets. Besides the standard
/// data, vertices have `global_vertex` and tets `global_tet`, their numbers in the whole mesh; vertices have `owner`,
/// the first rank that has them, and 0/1 under the name of each patch but one that is the whole boundary.
/// @return the files, the same on all ranks, the .pvtu last \throw KnownToAll naming a file
std::vector<std::filesystem::path> write_pvtu(MPI_Comm comm, const std::filesystem::path& pvtu,
                                              const DistributedMesh& mesh, const PieceExtras& extras = {});

/// The same of pieces that ranks write by themselves. @param has_piece  this rank does @param write  its own
/// @param point_data, cell_data  of the own piece: all ranks have the same arrays
std::vector<std::filesystem::path> write_pvtu(MPI_Comm comm, const std::filesystem::path& pvtu, bool has_piece,
                                              const std::map<std::string, FieldValues>& point_data,
                                              const std::map<std::string, FieldValues>& cell_data,
                                              const std::function<void(const std::filesystem::path&)>& write);

/// Each rank with tets a part of write_msh41_piece(), NAME_1.msh ..., with the tets of others that touch its own.
/// @return the files, the same on all ranks \throw KnownToAll naming a file
std::vector<std::filesystem::path> write_msh_pieces(MPI_Comm comm, const std::filesystem::path& msh,
                                                    const DistributedMesh& mesh, const PieceExtras& extras = {});

/// Puts the faces of a part into the patches of `extras`, where it has any. Collective. @return the patches
std::vector<MeshPart> divide_part(SolverPart& part, const PieceExtras& extras);

}  // namespace umtet
