#pragma once

#include <mpi.h>

#include <cstdio>
#include <exception>

#include "distributed/exchange/collect.h"
#include "distributed/io/shared_file.h"
#include "pipeline/case/exit_code.h"

namespace umtet {

/// Runs work() on all ranks at once and returns its result. If work() throws on one rank, other ranks may be waiting
/// for that rank, so all ranks end, with the message and exit code of the exception.
/// \throw KnownToAll  if work() throws it
template <class F>
auto together(MPI_Comm comm, const F& work) {
  try {
    return work();
  } catch (const KnownToAll&) {
    throw;
  } catch (...) {
    const Failure failure = failure_of(std::current_exception());
    std::fprintf(stderr, "umtet: rank %d: %s\n", rank_in(comm), failure.message.c_str());
    std::fflush(stderr);
    MPI_Abort(comm, static_cast<int>(failure.code));
    throw;  // not reached
  }
}

}  // namespace umtet
