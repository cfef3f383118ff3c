#pragma once

#include <mpi.h>

namespace umtet {

/// Marks the begin of a phase of this rank for MPI profilers. They replace MPI_Pcontrol(), which otherwise has no
/// effect. tests/bench/rank_traffic.c is one.
inline void begin_phase(const char* name) { MPI_Pcontrol(1, name); }

}  // namespace umtet
