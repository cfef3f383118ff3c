#pragma once

#include <functional>

#include "common/context.h"

namespace umtet {

/// A callback that the thread of the job calls every few milliseconds of work. It stops the job by throwing.
/// @param step  null: the step is the same as in the previous call
/// @param fraction  finished fraction of the step, in [0, 1]
using Watch = std::function<void(const char* step, double fraction)>;

/// Returns a context for a call of a library: the watch receives its progress and, by throwing, cancels it. The watch
/// must outlive the context.
Context context_of(const Watch& watch);
/// Returns a context for a call whose steps are reported elsewhere: the watch only cancels it.
Context polls_of(const Watch& watch);

}  // namespace umtet
