#pragma once

namespace umtet {

/// From now on SIGINT and SIGTERM ask the running stage to stop. Where it does not do so within 0.15 s, and at a second
/// signal, the process ends at once: everything in a case is whole at any time. Files that
/// grow beyond a limit and closed pipes become errors of write() instead of signals.
void install_signal_handlers();

/// The signal that asked to stop, or 0.
int interrupt_signal();

/// For libraries that ask whether to go on.
bool not_interrupted();

/// \throw Interrupted if a signal has asked to stop: called between the steps of a stage
void stop_if_interrupted();

}  // namespace umtet
