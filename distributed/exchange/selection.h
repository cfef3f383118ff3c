#pragma once

#include <mpi.h>

#include <cstdint>
#include <vector>

namespace umtet {

/// Distributed selection by bisection: for each of some counts, the least x such that this many numbers of all ranks
/// are below it. Takes a sum over ranks for each bit in which the numbers differ. The same on all ranks. Collective.
/// @param own     ascending
/// @param counts  the same on all ranks, at most the number of all numbers
std::vector<std::int64_t> bounds_of(MPI_Comm comm, const std::vector<std::int64_t>& own,
                                    const std::vector<std::uint64_t>& counts);

/// The values at some positions of the sorted list of all ranks. Collective.
/// @param own     ascending, no NaN; contains all values that may be among the lowest of these positions
/// @param places  positions, the same on all ranks
std::vector<double> values_at(MPI_Comm comm, const std::vector<double>& own, const std::vector<std::uint64_t>& places);

}  // namespace umtet
