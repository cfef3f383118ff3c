#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

#include "common/context.h"
#include "common/polled_loops.h"
#include "mesh/core/implicit_function.h"

// Loops whose bodies evaluate psi: with all threads, or in blocks if psi requests it. The results are the same.
namespace umtet {

/// Points per block: a megabyte or two of memory with the values, and enough work to outweigh the cost of a call a
/// thousand times.
inline constexpr std::size_t kPointsPerBlock = 1 << 14;

/// Calls f(i) for every i < n; the calls must not depend on each other. Uses threads over i, and polls before every
/// `per_poll` calls. If psi is evaluated in blocks, the calling thread evaluates it. \throw Cancelled
template <class F>
void for_each_asking(ImplicitFunctionRef psi, std::size_t n, std::size_t per_poll, const Context& context, const F& f) {
  const SideBySide* side_by_side = psi.side_by_side();
  if (!side_by_side) return polled_parallel_for(n, per_poll, context, f);
  // Blocks get smaller towards the end of a piece.
  const std::size_t piece = std::max(per_poll, kPointsPerBlock);
  for (std::size_t begin = 0; begin < n; begin += piece) {
    context.poll();
    side_by_side->for_each(std::min(piece, n - begin), [&](std::size_t i) { f(begin + i); });
  }
}

/// Sum of the contributions of f(i, sum) for begin <= i < end, by threads or in blocks; for integers, whose order does
/// not matter.
/// @param per_task  least number of values per task of a thread
template <class T, class F>
T sum_asking(ImplicitFunctionRef psi, std::size_t begin, std::size_t end, std::size_t per_task, const Context& context,
             const F& f) {
  if (!psi.side_by_side()) return polled_parallel_sum<T>(begin, end, per_task, kValuesPerPoll, context, f);
  T sum{};
  for_each_asking(psi, end - begin, kValuesPerPoll, context, [&](std::size_t i) { f(begin + i, sum); });
  return sum;
}

/// Calls take(i, psi(point(i))) for every i < n in ascending order, for a psi that is evaluated in blocks. \throw
/// Cancelled
template <class Point, class Take>
void take_in_blocks(ImplicitFunctionRef psi, std::size_t n, const Context& context, const Point& point,
                    const Take& take) {
  std::vector<Vec3> x;
  std::vector<double> value(std::min(n, kPointsPerBlock));
  for (std::size_t begin = 0; begin < n; begin += kPointsPerBlock) {
    context.poll();
    x.clear();
    for (std::size_t i = begin; i < std::min(n, begin + kPointsPerBlock); ++i) x.push_back(point(i));
    psi.values(x, value.data());
    for (std::size_t i = 0; i < x.size(); ++i) take(begin + i, value[i]);
  }
}

/// psi(point(i)) for every i < n, by all threads or in blocks. \throw Cancelled
template <class Point>
std::vector<double> values_at(ImplicitFunctionRef psi, std::size_t n, const Context& context, const Point& point) {
  std::vector<double> value(n);
  if (psi.side_by_side()) {
    take_in_blocks(psi, n, context, point, [&](std::size_t i, double psi_i) { value[i] = psi_i; });
  } else {
    polled_parallel_for(n, kValuesPerPoll * 16, context, [&](std::size_t i) { value[i] = psi.value(point(i)); });
  }
  return value;
}

}  // namespace umtet
