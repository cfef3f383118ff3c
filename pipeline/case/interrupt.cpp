#include "pipeline/case/interrupt.h"

#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <initializer_list>
#include <new>

#include "pipeline/case/exit_code.h"
#include "pipeline/case/stop_document.h"

namespace umtet {
namespace {

std::atomic<int> asked_by{0};
std::atomic<const char*> work{"start"};
std::atomic<bool> in_own_time{false};
std::atomic<const char*> answers_to{nullptr};  ///< the command whose caller waits for a document
std::terminate_handler other_end = nullptr;
// Else a signal handler may not touch them.
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<const char*>::is_always_lock_free &&
              std::atomic<bool>::is_always_lock_free);

// Steps poll more often than this; a few library calls on large clouds take longer, and end without their say. A fifth
// of a second is promised, and what the kernel takes back of a large process is part of it.
constexpr long kPatienceMicroseconds = 100'000;

void write_all(int file, std::initializer_list<const char*> texts) {
  for (const char* text : texts) [[maybe_unused]] const auto written = ::write(file, text, std::strlen(text));
}

void say(const char* text) { write_all(STDERR_FILENO, {text}); }

int code_of(int signal) { return signal == SIGALRM ? static_cast<int>(ExitCode::ResourceLimit) : 128 + signal; }

/// Every file of a case is renamed into place when it is whole, so the process may end at any instruction.
[[noreturn]] void stop_now(int signal) {
  const char* what = signal == SIGALRM ? "out of time" : signal == SIGTERM ? "terminated" : "interrupted";
  const char* resume = "; the case can be resumed with the same command";
  write_all(STDERR_FILENO, {"\numtet: ", what, " in ", work.load(), resume, "\n"});
  if (const char* command = answers_to.load()) {
    const char* code = signal == SIGALRM ? "9" : signal == SIGTERM ? "143" : "130";
    write_all(STDOUT_FILENO, {"{\n  \"schema\": 1,\n  \"command\": \"", command, "\",\n  \"exit_code\": ", code,
                              ",\n  \"error\": \"", what, " in ", work.load(), resume, "\"\n}\n"});
  }
  ::_exit(code_of(signal));
}

extern "C" void ask_to_stop(int signal) {
  if (asked_by.exchange(signal) != 0) stop_now(signal);
  if (in_own_time) return;
  const itimerval once{{0, 0}, {0, kPatienceMicroseconds}};
  ::setitimer(ITIMER_REAL, &once, nullptr);
}

/// The time limit, or the end of patience.
extern "C" void time_is_over(int) {
  if (const int signal = asked_by.load()) stop_now(signal);
  ask_to_stop(SIGALRM);
}

/// nlohmann's ordered_map and libstdc++'s directory_iterator allocate in noexcept functions.
[[noreturn]] void end_without_catcher() {
  try {
    if (const std::exception_ptr error = std::current_exception()) std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    say("umtet: out of memory in ");
    say(work.load());
    say("\n");
    ::_exit(static_cast<int>(ExitCode::ResourceLimit));
  } catch (...) {
  }
  if (other_end) other_end();  // says what it was
  std::abort();
}

}  // namespace

void install_signal_handlers() {
  other_end = std::set_terminate(end_without_catcher);
  struct sigaction action {};
  action.sa_handler = ask_to_stop;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  action.sa_handler = time_is_over;
  ::sigaction(SIGALRM, &action, nullptr);
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
}

void stop_after(double seconds) {
  const double whole = std::floor(seconds);
  // A timer of zero would be none.
  const long rest = std::max(1L, static_cast<long>(1e6 * (seconds - whole)));
  const itimerval once{{0, 0}, {static_cast<time_t>(whole), rest}};
  ::setitimer(ITIMER_REAL, &once, nullptr);
}

void stop_in_own_time() { in_own_time = true; }

void answer_stops_in_json(const char* command) { answers_to = command; }

void set_work_at_hand(const char* name) { work = name; }

const char* work_at_hand() { return work.load(); }

int interrupt_signal() { return asked_by.load(); }

const Context& until_interrupted() {
  static const Context context{.cancelled = [] { return interrupt_signal() != 0; }};
  return context;
}

void stop_if_interrupted() {
  if (const int signal = interrupt_signal()) throw Interrupted(signal);
}

}  // namespace umtet
