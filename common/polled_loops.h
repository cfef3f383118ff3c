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

// Loops over all threads that a Context can end. The thread that made the call polls between pieces of its own work and
// no thread waits for it to do so: a barrier at each poll would cost more than the work between two of them.
namespace umtet {

/// Calls of psi, or of something that costs a few of them, between two polls: a hundredth of a second for a psi that
/// takes ten microseconds a value, and still a thousand times the cost of a poll.
inline constexpr std::size_t kValuesPerPoll = 1 << 12;

namespace detail {

/// f(i) for every i of the range, with a poll before every `per_poll` of them, by the thread that made the call. What
/// another one leaves undone is that of a call that ends. \throw Cancelled
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

/// f(i) for every i < n, threads over i. Polls once at least, and before every `per_poll` values of the thread that
/// made the call. \throw Cancelled
template <class F>
void polled_parallel_for(std::size_t n, std::size_t per_poll, const Context& context, const F& f) {
  context.poll();
  const std::thread::id caller = std::this_thread::get_id();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n),
                    [&](const auto& range) { detail::polled_range(range, per_poll, caller, context, f); });
}

/// The sum of what f(i, sum) adds for every begin <= i < end, threads over at least `per_task` values each; polls as
/// above. The sum has to be the same in any order: T is an integer, or several. \throw Cancelled
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
