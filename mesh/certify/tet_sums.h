#pragma once

#include <array>
#include <cstddef>

// How a certificate adds up what it measures of tets: the same doubles to the bit, whoever has measured them.
namespace umtet {

/// Consecutive tets that are summed by themselves, before the sums are added one after the other.
inline constexpr std::size_t kTetsPerSum = 1 << 10;

struct TetSums {
  double volume6 = 0, rms_edges = 0, qualities = 0;

  void add(const TetSums& next) {
    volume6 += next.volume6;
    rms_edges += next.rms_edges;
    qualities += next.qualities;
  }
};

/// Sums of n <= kTetsPerSum consecutive tets, in four lanes, as tets are measured (tet_packs.h).
/// @param value  value(k) is what the k-th of them adds, a TetSums
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
