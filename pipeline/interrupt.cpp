#include "pipeline/interrupt.h"

#include <unistd.h>

#include <atomic>
#include <csignal>

#include "pipeline/exit_code.h"

namespace umtet {
namespace {

std::atomic<int> asked_by{0};
static_assert(std::atomic<int>::is_always_lock_free);  // else a signal handler may not touch it

extern "C" void ask_to_stop(int signal) {
  if (asked_by.exchange(signal) != 0) ::_exit(128 + signal);
}

}  // namespace

void install_signal_handlers() {
  struct sigaction action {};
  action.sa_handler = ask_to_stop;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
}

int interrupt_signal() { return asked_by.load(); }

bool not_interrupted() { return interrupt_signal() == 0; }

void stop_if_interrupted() {
  if (const int signal = interrupt_signal()) throw Interrupted(signal);
}

}  // namespace umtet
