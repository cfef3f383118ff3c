#pragma once

#include <functional>
#include <stdexcept>

namespace umtet {

/// Exception of a call that was cancelled through its Context.
struct Cancelled : std::runtime_error {
  Cancelled() : std::runtime_error("cancelled by the caller") {}
};

/// Progress and cancellation callbacks for long-running calls. The calling thread invokes both functions. They may
/// throw, which also ends the call. Either may be empty.
struct Context {
  /// Receives the name of a step, and the completed fraction of the current call, in [0, 1].
  std::function<void(const char* step, double fraction)> progress = {};
  /// Called every few milliseconds between pieces of work; if it returns true, the call ends with Cancelled.
  std::function<bool()> cancelled = {};

  /// Checks for cancellation. \throw Cancelled
  void poll() const {
    if (cancelled && cancelled()) throw Cancelled();
  }
  /// Reports progress and checks for cancellation. \throw Cancelled
  void report(const char* step, double fraction) const {
    if (progress) progress(step, fraction);
    poll();
  }
  /// Context for a nested call whose progress [0, 1] is mapped to [begin, end] of this one.
  Context part(double begin, double end) const {
    if (!progress) return {.cancelled = cancelled};
    return {.progress = [whole = progress, begin, end](const char* step,
                                                       double f) { whole(step, begin + (end - begin) * f); },
            .cancelled = cancelled};
  }
};

}  // namespace umtet
