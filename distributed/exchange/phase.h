#pragma once

#include <mpi.h>

namespace umtet {

/// Marks the beginning of a phase of this rank for MPI profilers, such as tests/bench/rank_traffic.c. A profiler
/// replaces MPI_Pcontrol(), which otherwise has no effect.
inline void begin_phase(const char* name) { MPI_Pcontrol(1, name); }

}  // namespace umtet
