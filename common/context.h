#pragma once

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

}  // namespace umtet
