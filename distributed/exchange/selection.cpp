#include "distributed/exchange/selection.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace umtet {
namespace {

/// Maps the bits of a double to an integer with the same order. The map is its own inverse.
std::int64_t ordered_bits(std::int64_t bits) {
  return bits >= 0 ? bits : bits ^ std::numeric_limits<std::int64_t>::max();
}

}  // namespace

std::vector<std::int64_t> bounds_of(MPI_Comm comm, const std::vector<std::int64_t>& own,
                                    const std::vector<std::uint64_t>& counts) {
  using Limits = std::numeric_limits<std::int64_t>;
  std::int64_t least = own.empty() ? Limits::max() : own.front(), most = own.empty() ? Limits::min() : own.back();
  MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPI_INT64_T, MPI_MIN, comm);
  MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_INT64_T, MPI_MAX, comm);
  if (least > most) return std::vector<std::int64_t>(counts.size(), 0);  // no rank has a value
  // Unsigned distances from the least value, because the range may need all 64 bits.
  const auto at = [&](std::uint64_t distance) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(least) + distance);
  };
  const std::uint64_t range = static_cast<std::uint64_t>(most) - static_cast<std::uint64_t>(least) + 1;
  std::vector<std::uint64_t> low(counts.size(), 0), high(counts.size(), range), below(counts.size());
  for (std::uint64_t left = range; left > 0; left /= 2) {
    for (std::size_t k = 0; k < counts.size(); ++k) {
      const auto middle = std::lower_bound(own.begin(), own.end(), at(low[k] + (high[k] - low[k]) / 2));
      below[k] = static_cast<std::uint64_t>(middle - own.begin());
    }
    MPI_Allreduce(MPI_IN_PLACE, below.data(), static_cast<int>(below.size()), MPI_UINT64_T, MPI_SUM, comm);
    for (std::size_t k = 0; k < counts.size(); ++k) {
      const std::uint64_t middle = low[k] + (high[k] - low[k]) / 2;
      if (low[k] == high[k]) continue;
      below[k] >= counts[k] ? high[k] = middle : low[k] = middle + 1;
    }
  }
  std::vector<std::int64_t> bounds;
  for (const std::uint64_t distance : low) bounds.push_back(at(distance));
  return bounds;
}

std::vector<double> values_at(MPI_Comm comm, const std::vector<double>& own, const std::vector<std::uint64_t>& places) {
  std::vector<std::int64_t> bits;
  for (const double x : own) bits.push_back(ordered_bits(std::bit_cast<std::int64_t>(x)));
  std::vector<std::uint64_t> counts;
  for (const std::uint64_t place : places) counts.push_back(place + 1);
  std::vector<double> values;
  for (const std::int64_t bound : bounds_of(comm, bits, counts))
    values.push_back(std::bit_cast<double>(ordered_bits(bound - 1)));
  return values;
}

}  // namespace umtet
