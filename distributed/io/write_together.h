#pragma once

#include <mpi.h>

#include <filesystem>
#include <system_error>

#include "distributed/io/shared_file.h"

namespace umtet {

/// What one rank writes, and whether all have. A std::system_error of any rank all throw, as KnownToAll; what else
/// write() throws is for together(). Collective.
template <class Write>
void write_together(MPI_Comm comm, const std::filesystem::path& file, bool does, const Write& write) {
  int error = 0;
  try {
    if (does) write();
  } catch (const std::system_error& e) {
    error = e.code().value();
  }
  MPI_Allreduce(MPI_IN_PLACE, &error, 1, MPI_INT, MPI_MAX, comm);
  if (error != 0) throw KnownToAll(error, std::generic_category(), "cannot write " + file.string());
}

}  // namespace umtet
