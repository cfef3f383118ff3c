#pragma once

#include <mpi.h>

#include <cstdint>
#include <vector>

namespace umtet {

/// Distributed selection by bisection: returns for each of some counts the least x such that at least this number of
/// values of all ranks is below it. It takes a reduction over all ranks for each bit in which the values differ.
/// Collective; the result is the same on all ranks.
/// @param own     values of this rank, ascending
/// @param counts  the same on all ranks; each is at most the total number of values
std::vector<std::int64_t> bounds_of(MPI_Comm comm, const std::vector<std::int64_t>& own,
                                    const std::vector<std::uint64_t>& counts);

/// Returns the values at some positions of the sorted list of all ranks. Collective.
/// @param own     values of this rank, ascending, without NaN; values above the greatest of the positions may be
///                missing
/// @param places  positions, the same on all ranks
std::vector<double> values_at(MPI_Comm comm, const std::vector<double>& own, const std::vector<std::uint64_t>& places);

}  // namespace umtet
