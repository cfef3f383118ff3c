#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <stdexcept>

namespace umtet {

/// What a call throws that was cancelled through its Context.
struct Cancelled : std::runtime_error {
  Cancelled() : std::runtime_error("cancelled by the caller") {}
};

/// How a caller follows a call of some seconds and ends it. Both functions are called by the thread that made the call,
/// and may throw, which ends the call too; either may be empty.
struct Context {
  /// Where the work stands: the name of a step, and the part of the call at hand that is done, in [0, 1].
  std::function<void(const char* step, double fraction)> progress = {};
  /// Called between pieces of work of some milliseconds; true ends the call with Cancelled.
  std::function<bool()> cancelled = {};

  /// \throw Cancelled
  void poll() const {
    if (cancelled && cancelled()) throw Cancelled();
  }
  /// \throw Cancelled
  void report(const char* step, double fraction) const {
    if (progress) progress(step, fraction);
    poll();
  }
  /// For a call that is a part of this one: its [0, 1] is [begin, end] here.
  Context part(double begin, double end) const {
    if (!progress) return {.cancelled = cancelled};
    return {.progress = [whole = progress, begin, end](const char* step,
                                                       double f) { whole(step, begin + (end - begin) * f); },
            .cancelled = cancelled};
  }
};

/// f(i) for every i < n, threads over i. Polls before every `per_poll` of them. \throw Cancelled
template <class F>
void polled_parallel_for(std::size_t n, std::size_t per_poll, const Context& context, const F& f) {
  for (std::size_t begin = 0; begin < n; begin += per_poll) {
    context.poll();
    tbb::parallel_for(begin, std::min(n, begin + per_poll), f);
  }
}

/// Calls of psi, or of something that costs a few of them, between two polls: a hundredth of a second for a psi that
/// takes ten microseconds a value, and still a thousand times the cost of a poll.
inline constexpr std::size_t kValuesPerPoll = 1 << 12;

}  // namespace umtet
