#pragma once

#include "common/context.h"

namespace umtet {

/// Installs handlers by which SIGINT and SIGTERM request the running stage to stop. If it does not stop within 0.1
/// s, or if a second signal arrives, the process ends at once; the files of a case are complete at any time. All
/// signals are handled one after the other in the thread that calls this function; the answer of the program and
/// the answer to a signal exclude each other (stop_document.h). Files that exceed a limit and closed pipes become
/// errors of write() instead of signals. A failed allocation that cannot be caught (in noexcept functions of
/// libraries) ends the process with exit code 9.
void install_signal_handlers();

/// Requests a stop after this many seconds, in the same way as a signal, with exit code 9.
void stop_after(double seconds);

/// Disables the end after 0.1 s, for a caller that notices signals at once and must stop other processes before it
/// ends.
void stop_in_own_time();

/// Sets the name of the current stage, for messages about an early end.
/// @param work  lives as long as the program
void set_work_at_hand(const char* work);
const char* work_at_hand();

/// Returns the signal that requested a stop (SIGALRM: time limit reached), or 0.
int interrupt_signal();

/// Returns a context for calls of libraries, which are cancelled when a signal requests a stop.
const Context& until_interrupted();

/// Call it between the steps of a stage. \throw Interrupted  a signal has requested a stop
void stop_if_interrupted();

}  // namespace umtet
