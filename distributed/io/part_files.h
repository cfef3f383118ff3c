#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "distributed/distributed_mesh.h"

// Files of what all ranks have, without a gather. Places are those of the file. All functions are collective.
namespace umtet {

/// What write_vtu() writes of the whole mesh with_standard_data(), byte for byte, by MPI-IO: each rank has pieces of
/// consecutive vertices and tets in turn, and writes them where they belong.
/// @param boundary  of the vertices of the own mesh, where it is another than that of its tets
/// \pre all ranks see one file system. \throw KnownToAll naming the file; what is there then is no mesh
void write_whole_vtu(MPI_Comm comm, const std::filesystem::path& file, const DistributedMesh& mesh,
                     const std::vector<std::uint8_t>* boundary = nullptr);

/// Some tets with their vertices. \pre ascending
DistributedMesh some_of(const DistributedMesh& mesh, const std::vector<std::size_t>& tets);

/// Each rank its own tets as a piece, NAME_RANK.vtu, and a NAME.pvtu that lists those with tets. Besides the standard
/// data, vertices have `global_vertex` and tets `global_tet`, their numbers in the whole mesh; vertices have `owner`,
/// the rank that owns them: what several pieces have is of that one.
/// @return the files, the same on all ranks, the .pvtu first \throw KnownToAll naming a file
std::vector<std::filesystem::path> write_pvtu(MPI_Comm comm, const std::filesystem::path& pvtu,
                                              const DistributedMesh& mesh);

}  // namespace umtet
