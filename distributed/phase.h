#pragma once

#include <mpi.h>

namespace umtet {

/// What this rank does from now on, for profilers of MPI: they take the place of MPI_Pcontrol(), which does nothing
/// without one. tests/bench/rank_traffic.c is one.
inline void begin_phase(const char* name) { MPI_Pcontrol(1, name); }

}  // namespace umtet
