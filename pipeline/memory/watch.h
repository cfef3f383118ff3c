#pragma once

#include <functional>

#include "common/context.h"

namespace umtet {

/// Called by the thread that called the job, every few milliseconds of work. It stops the job by throwing.
/// @param step  null: still in the step that was named last
/// @param fraction  of the step, in [0, 1]
using Watch = std::function<void(const char* step, double fraction)>;

/// A call of a library that the watch follows and, where it throws, ends; it must outlive the context.
Context context_of(const Watch& watch);
/// The same of a call that is a part of one whose steps are told otherwise.
Context polls_of(const Watch& watch);

}  // namespace umtet
