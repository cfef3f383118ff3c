#pragma once

namespace umtet {

/// SIGINT and SIGTERM to one of several processes, behind install_signal_handlers() of rank 0. One that is sent a
/// signal by a user ends with the words and the exit code of one process, and what started them (mpirun) ends the
/// others: it sends them SIGTERM, and SIGKILL within a second, so nobody else speaks. A batch system that sends all of
/// them SIGTERM leaves them more time: rank 0 speaks for all.
void share_signals(int rank);

}  // namespace umtet
