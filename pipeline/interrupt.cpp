#include "pipeline/interrupt.h"

#include <sys/time.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstring>

#include "pipeline/exit_code.h"

namespace umtet {
namespace {

std::atomic<int> asked_by{0};
static_assert(std::atomic<int>::is_always_lock_free);  // else a signal handler may not touch it

// Steps poll about every tenth of a second; a few library calls on large clouds take longer.
constexpr long kPatienceMicroseconds = 150'000;

/// Every file of a case is renamed into place when it is whole, so the process may end at any instruction.
[[noreturn]] void stop_now(int signal) {
  const char* text = signal == SIGTERM ? "\numtet: terminated; the case can be resumed with the same command\n"
                                       : "\numtet: interrupted; the case can be resumed with the same command\n";
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text, std::strlen(text));
  ::_exit(128 + signal);
}

extern "C" void ask_to_stop(int signal) {
  if (asked_by.exchange(signal) != 0) ::_exit(128 + signal);
  const itimerval once{{0, 0}, {0, kPatienceMicroseconds}};
  ::setitimer(ITIMER_REAL, &once, nullptr);
}

extern "C" void lose_patience(int) { stop_now(asked_by.load()); }

}  // namespace

void install_signal_handlers() {
  struct sigaction action {};
  action.sa_handler = ask_to_stop;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  action.sa_handler = lose_patience;
  ::sigaction(SIGALRM, &action, nullptr);
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
}

int interrupt_signal() { return asked_by.load(); }

bool not_interrupted() { return interrupt_signal() == 0; }

void stop_if_interrupted() {
  if (const int signal = interrupt_signal()) throw Interrupted(signal);
}

}  // namespace umtet
