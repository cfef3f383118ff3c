#pragma once

#include "common/context.h"

namespace umtet {

/// From now on SIGINT and SIGTERM ask the running stage to stop. Where it does not do so within 0.1 s, and at a second
/// signal, the process ends at once: everything in a case is whole at any time. All signals are answered in the thread
/// that calls this, one after the other; the answer of the program and that of a signal exclude each other
/// (stop_document.h). Files that grow beyond a limit and closed pipes become errors of write() instead of signals. An
/// allocation that fails where nothing can be caught (in noexcept functions of libraries) ends the process with exit
/// code 9.
void install_signal_handlers();

/// Asks to stop after so many seconds, as by a signal, with exit code 9.
void stop_after(double seconds);

/// For a caller that hears of a signal at once and has others to stop before it ends: no end after 0.1 s.
void stop_in_own_time();

/// What the program is doing, for messages about an end on the way: the name of a stage.
/// @param work  lives as long as the program
void set_work_at_hand(const char* work);
const char* work_at_hand();

/// The signal that asked to stop (SIGALRM: time is over), or 0.
int interrupt_signal();

/// For calls of libraries: a signal that asks to stop cancels them.
const Context& until_interrupted();

/// \throw Interrupted if a signal has asked to stop: called between the steps of a stage
void stop_if_interrupted();

}  // namespace umtet
