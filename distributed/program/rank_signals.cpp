#include "distributed/program/rank_signals.h"

#include <sys/time.h>
#include <unistd.h>

#include <atomic>
#include <charconv>
#include <csignal>
#include <cstring>
#include <string_view>

#include "pipeline/case/interrupt.h"

namespace umtet {
namespace {

struct sigaction former[NSIG];  // the former handlers of rank 0
std::atomic<int> asked_by{0};   // on rank 0: a signal of the launcher that is not yet handled; else 0
int own_rank = 0;
static_assert(std::atomic<int>::is_always_lock_free);  // otherwise a signal handler must not use it

// Delay before rank 0 handles a signal of the launcher: twice the time that mpirun leaves to the processes that it
// ends.
constexpr int kPatienceSeconds = 2;

bool is_of_launcher(const siginfo_t* info) { return info->si_code <= 0 && info->si_pid == ::getppid(); }

extern "C" void answer_of_first(int signal, siginfo_t* info, void*) {
  if (signal == SIGALRM) {
    const int waiting = asked_by.exchange(0);
    if (waiting != 0) signal = waiting;  // otherwise the alarm is for the time limit, or of install_signal_handlers()
  } else if (is_of_launcher(info)) {
    asked_by = signal;
    const itimerval once{{0, 0}, {kPatienceSeconds, 0}};
    ::setitimer(ITIMER_REAL, &once, nullptr);
    return;
  }
  former[signal].sa_handler(signal);
}

extern "C" void answer_of_other(int signal, siginfo_t* info, void*) {
  if (!is_of_launcher(info)) {
    char text[200] = "\numtet: rank ";
    char* end = std::to_chars(text + std::strlen(text), text + sizeof text, own_rank).ptr;
    for (const std::string_view part : {signal == SIGTERM ? ": terminated in " : ": interrupted in ", work_at_hand(),
                                        "; the case can be resumed with the same command\n"})
      end += part.copy(end, static_cast<std::size_t>(text + sizeof text - end));
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text, static_cast<std::size_t>(end - text));
  }
  ::_exit(128 + signal);
}

void handle(int signal, void (*handler)(int, siginfo_t*, void*)) {
  struct sigaction action {};
  action.sa_sigaction = handler;
  action.sa_flags = SA_RESTART | SA_SIGINFO;
  sigemptyset(&action.sa_mask);
  for (const int other : {SIGINT, SIGTERM, SIGALRM}) sigaddset(&action.sa_mask, other);
  ::sigaction(signal, &action, &former[signal]);
}

}  // namespace

void share_signals(int rank) {
  own_rank = rank;
  for (const int signal : {SIGINT, SIGTERM}) handle(signal, rank == 0 ? answer_of_first : answer_of_other);
  if (rank == 0) handle(SIGALRM, answer_of_first);
}

}  // namespace umtet
