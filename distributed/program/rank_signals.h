#pragma once

namespace umtet {

/// Handles SIGINT and SIGTERM in one of several processes, after install_signal_handlers() of rank 0. A process that
/// receives a signal from a user ends with the message and exit code of one process. The launcher (mpirun) then ends
/// the others: it sends them SIGTERM, and SIGKILL within a second, so they print no message. A batch system that sends
/// SIGTERM to all of them allows more time, and rank 0 prints the message for all.
void share_signals(int rank);

}  // namespace umtet
