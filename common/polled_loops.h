#pragma once

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_reduce.h>
#include <oneapi/tbb/task.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <thread>

#include "common/context.h"

// Parallel loops that a Context can cancel. The calling thread polls between pieces of its own work, and no thread
// waits for it: a barrier at each poll would cost more than the work between two polls.
namespace umtet {

/// Evaluations of psi, or operations that cost a few of them, between two polls. This is a hundredth of a second for a
/// psi that takes ten microseconds per value, and still a thousand times the cost of a poll.
inline constexpr std::size_t kValuesPerPoll = 1 << 12;

namespace detail {

/// Calls f(i) for every i of the range. The calling thread polls before every `per_poll` calls; other threads stop
/// early only if the loop is being cancelled. \throw Cancelled
template <class F>
void polled_range(const tbb::blocked_range<std::size_t>& range, std::size_t per_poll, std::thread::id caller,
                  const Context& context, const F& f) {
  for (std::size_t begin = range.begin(); begin < range.end(); begin += per_poll) {
    if (std::this_thread::get_id() == caller) {
      context.poll();
    } else if (tbb::is_current_task_group_canceling()) {
      return;
    }
    const std::size_t end = std::min(range.end(), begin + per_poll);
    for (std::size_t i = begin; i != end; ++i) f(i);
  }
}

}  // namespace detail

/// Calls f(i) for every i < n, with threads over i. The calling thread polls at least once, and before every `per_poll`
/// of its values. \throw Cancelled
template <class F>
void polled_parallel_for(std::size_t n, std::size_t per_poll, const Context& context, const F& f) {
  context.poll();
  const std::thread::id caller = std::this_thread::get_id();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n),
                    [&](const auto& range) { detail::polled_range(range, per_poll, caller, context, f); });
}

/// Sum of the contributions of f(i, sum) for begin <= i < end, with threads over at least `per_task` values each. Polls
/// as polled_parallel_for(). The sum must be the same in any order: T is an integer, or consists of several. \throw
/// Cancelled
template <class T, class F>
T polled_parallel_sum(std::size_t begin, std::size_t end, std::size_t per_task, std::size_t per_poll,
                      const Context& context, const F& f) {
  context.poll();
  const std::thread::id caller = std::this_thread::get_id();
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(begin, std::max(begin, end), per_task), T{},
      [&](const auto& range, T sum) {
        detail::polled_range(range, per_poll, caller, context, [&](std::size_t i) { f(i, sum); });
        return sum;
      },
      std::plus<T>());
}

}  // namespace umtet
