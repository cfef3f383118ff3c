#pragma once

#include <mpi.h>

#include <filesystem>
#include <system_error>

#include "distributed/io/shared_file.h"

namespace umtet {

/// Writes a file on some ranks, and checks success on all. If write() throws a std::system_error on a rank, all ranks
/// throw KnownToAll; together() handles other exceptions. Collective.
/// @param does  whether this rank calls write()
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
