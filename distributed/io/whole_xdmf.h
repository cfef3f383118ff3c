#pragma once

#include <mpi.h>

#include <filesystem>
#include <vector>

#include "distributed/mesh/distributed_mesh.h"

namespace umtet {

/// Writes the files of `umtet export --format xdmf` for the whole mesh, with the same arrays in the HDF5 file: NAME.h5,
/// NAME.xdmf and NAME_boundary.xdmf. HDF5 on rank 0 determines the position of each array, and each rank writes its
/// pieces there by MPI-IO, because parallel HDF5 cannot be in one process with the serial HDF5. Collective.
/// @return the files, the same on all ranks
/// \pre all ranks have a common file system
/// \throw KnownToAll naming a file
std::vector<std::filesystem::path> write_whole_xdmf(MPI_Comm comm, const std::filesystem::path& xdmf,
                                                    const DistributedMesh& mesh);

}  // namespace umtet
