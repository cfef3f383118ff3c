#pragma once

#include <mpi.h>

#include <cstdint>
#include <vector>

namespace umtet {

/// For each of some counts the least x below which there are as many numbers, of all ranks together, by bisection: a
/// sum over ranks for each bit in which they differ. The same on all ranks. Collective.
/// @param own     ascending
/// @param counts  the same on all ranks, at most as many as there are numbers
std::vector<std::int64_t> bounds_of(MPI_Comm comm, const std::vector<std::int64_t>& own,
                                    const std::vector<std::uint64_t>& counts);

/// The values that have these places among all of all ranks, as if they were sorted. Collective.
/// @param own     ascending, no NaN; all that may be among the lowest of these places
/// @param places  the same on all ranks
std::vector<double> values_at(MPI_Comm comm, const std::vector<double>& own, const std::vector<std::uint64_t>& places);

}  // namespace umtet
