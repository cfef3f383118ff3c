#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

#include "common/context.h"
#include "common/polled_loops.h"
#include "mesh/core/implicit_function.h"

// Loops whose bodies ask psi: by all threads, or in blocks if psi wants that. The results are the same.
namespace umtet {

/// Points of a block of values: a megabyte or two with the answers, and a thousand times what a call costs.
inline constexpr std::size_t kPointsPerBlock = 1 << 14;

/// f(i) for every i < n, which do not depend on each other. Threads over i, with a poll before every `per_poll` of
/// them; a psi that is asked in blocks is asked by the thread that called. \throw Cancelled
template <class F>
void for_each_asking(ImplicitFunctionRef psi, std::size_t n, std::size_t per_poll, const Context& context, const F& f) {
  const SideBySide* side_by_side = psi.side_by_side();
  if (!side_by_side) return polled_parallel_for(n, per_poll, context, f);
  // At the end of a piece the blocks get smaller.
  const std::size_t piece = std::max(per_poll, kPointsPerBlock);
  for (std::size_t begin = 0; begin < n; begin += piece) {
    context.poll();
    side_by_side->for_each(std::min(piece, n - begin), [&](std::size_t i) { f(begin + i); });
  }
}

/// The sum of what f(i, sum) adds for every begin <= i < end, like that; of integers, whose order does not matter.
/// @param per_task  values that a thread takes at least
template <class T, class F>
T sum_asking(ImplicitFunctionRef psi, std::size_t begin, std::size_t end, std::size_t per_task, const Context& context,
             const F& f) {
  if (!psi.side_by_side()) return polled_parallel_sum<T>(begin, end, per_task, kValuesPerPoll, context, f);
  T sum{};
  for_each_asking(psi, end - begin, kValuesPerPoll, context, [&](std::size_t i) { f(begin + i, sum); });
  return sum;
}

/// take(i, psi(point(i))) for every i < n in ascending order, of a psi that is asked in blocks. \throw Cancelled
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

/// psi(point(i)) for every i < n: by all threads, or in blocks. \throw Cancelled
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
