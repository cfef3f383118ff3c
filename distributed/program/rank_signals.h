#pragma once

namespace umtet {

/// Installs the handlers of SIGINT and SIGTERM in an MPI process. Rank 0 calls install_signal_handlers() first. A
/// process that receives a signal from a user ends with the same message and exit code as the serial program. The
/// launcher (mpirun) then ends the other processes: it sends them SIGTERM, and SIGKILL within a second, so they print
/// no message. A batch system that sends SIGTERM to all processes allows more time, and rank 0 prints one message for
/// all.
void share_signals(int rank);

}  // namespace umtet
