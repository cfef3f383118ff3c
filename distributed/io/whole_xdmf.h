#pragma once

#include <mpi.h>

#include <filesystem>
#include <vector>

#include "distributed/distributed_mesh.h"

namespace umtet {

/// What `umtet export --format xdmf` writes of the whole mesh, with the same arrays in the HDF5 file: NAME.h5,
/// NAME.xdmf and NAME_boundary.xdmf. HDF5 says on rank 0 where each array is, and each rank writes its pieces of them
/// there by MPI-IO: the parallel HDF5 cannot be in one process with the serial one, which VTK needs. Collective.
/// @return the files, the same on all ranks \pre all ranks see one file system. \throw KnownToAll naming a file
std::vector<std::filesystem::path> write_whole_xdmf(MPI_Comm comm, const std::filesystem::path& xdmf,
                                                    const DistributedMesh& mesh);

}  // namespace umtet
