#pragma once

#include <array>
#include <cstddef>

// Summation of the measures of tets in a certificate: the sums are the same to the bit, whichever process has measured
// the tets.
namespace umtet {

/// Number of consecutive tets that are summed first, before their sums are added in order.
inline constexpr std::size_t kTetsPerSum = 1 << 10;

/// Sums over tets: six times the volume, root mean square edge lengths, and mean ratios.
struct TetSums {
  double volume6 = 0, rms_edges = 0, qualities = 0;

  void add(const TetSums& next) {
    volume6 += next.volume6;
    rms_edges += next.rms_edges;
    qualities += next.qualities;
  }
};

/// Sums over n <= kTetsPerSum consecutive tets, in four lanes, in which tets are measured (tet_packs.h).
/// @param value  value(k) returns the contribution of the k-th tet, a TetSums
template <class Value>
TetSums block_sums(std::size_t n, const Value& value) {
  std::array<TetSums, 4> lane;
  for (std::size_t k = 0; k < n; ++k) lane[k % 4].add(value(k));
  lane[0].add(lane[1]);
  lane[2].add(lane[3]);
  lane[0].add(lane[2]);
  return lane[0];
}

}  // namespace umtet
