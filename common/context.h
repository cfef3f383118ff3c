#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <stdexcept>

namespace umtet {

/// Asked between pieces of work of some milliseconds, always by the thread that called the function: false = stop, with
/// MeshCancelled. Empty: never stops.
using KeepGoing = std::function<bool()>;

struct MeshCancelled : std::runtime_error {
  MeshCancelled() : std::runtime_error("stopped by the caller") {}
};

inline void poll(const KeepGoing& keep_going) {
  if (keep_going && !keep_going()) throw MeshCancelled();
}

/// f(i) for every i < n, threads over i. Asks before every `per_poll` of them. \throw MeshCancelled
template <class F>
void polled_parallel_for(std::size_t n, std::size_t per_poll, const KeepGoing& keep_going, const F& f) {
  for (std::size_t begin = 0; begin < n; begin += per_poll) {
    poll(keep_going);
    tbb::parallel_for(begin, std::min(n, begin + per_poll), f);
  }
}

/// Calls of psi, or of something that costs a few of them, between two questions: a hundredth of a second for the
/// dearest psi we know (ten microseconds a value), and still a thousand times the cost of the question.
inline constexpr std::size_t kValuesPerPoll = 1 << 12;

}  // namespace umtet
