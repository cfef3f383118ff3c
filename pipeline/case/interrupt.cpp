#include "pipeline/case/interrupt.h"

#include <poll.h>
#include <pthread.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <new>
#include <string_view>

#include "pipeline/case/exit_code.h"
#include "pipeline/case/stop_document.h"

namespace umtet {
namespace {

std::atomic<int> asked_by{0};
std::atomic<const char*> work{"start"};
std::atomic<bool> in_own_time{false};
std::atomic<const char*> answers_to{nullptr};  ///< the command whose caller expects a document
std::atomic<bool> last_word_taken{false};      ///< the thread that finds it false answers and ends the process
std::atomic<bool> last_word_said{false};
std::atomic<std::int64_t> reader_has_until{0};  ///< in us of the monotonic clock; 0: no limit
pthread_t first_thread;                         ///< the thread that answers signals, one after the other
std::terminate_handler other_end = nullptr;
// Otherwise a signal handler must not access them.
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<const char*>::is_always_lock_free &&
              std::atomic<bool>::is_always_lock_free && std::atomic<std::int64_t>::is_always_lock_free);

// Steps poll more often than this. A few library calls on large clouds take longer; the process ends during such a
// call. The documented limit is a fifth of a second, and the kernel needs part of it to free the memory of a large
// process.
constexpr int kPatienceMicroseconds = 100'000;
// After a signal, the process waits at most this long for a reader that does not read the answer.
constexpr int kReaderMicroseconds = 5'000'000;

int code_of(int signal) { return signal == SIGALRM ? static_cast<int>(ExitCode::ResourceLimit) : 128 + signal; }

void set_timer(std::int64_t microseconds) {
  const itimerval once{{0, 0}, {microseconds / 1'000'000, microseconds % 1'000'000}};
  ::setitimer(ITIMER_REAL, &once, nullptr);
}

std::int64_t now() {
  timespec time{};
  ::clock_gettime(CLOCK_MONOTONIC, &time);
  return std::int64_t{1'000'000} * time.tv_sec + time.tv_nsec / 1000;
}

/// Builds a short text without allocation and writes it in one call: a pipe takes up to PIPE_BUF bytes atomically.
class ErrorText {
 public:
  ErrorText& operator<<(std::string_view text) {
    size_ += text.copy(text_ + size_, sizeof(text_) - size_);
    return *this;
  }
  std::string_view text() const { return {text_, size_}; }
  void write(int file) const {
    pollfd reader{file, POLLOUT, 0};
    int ready;
    do ready = ::poll(&reader, 1, kReaderMicroseconds / 1000);
    while (ready < 0 && errno == EINTR);
    if (ready > 0) [[maybe_unused]]
      const auto written = ::write(file, text_, size_);
  }

 private:
  char text_[2000];
  std::size_t size_ = 0;
};

/// Writes the message and the document of a failure and ends the process, in a context where nothing can be
/// allocated or caught. Every file of a case is renamed into place when it is complete, so the process may end at
/// any instruction.
/// @param code  the status in digits
[[noreturn]] void end_now(const ErrorText& error, const char* code, int status) {
  (ErrorText() << "\numtet: " << error.text() << "\n").write(STDERR_FILENO);
  if (const char* command = answers_to.load()) {
    (ErrorText() << "{\n  \"schema\": 1,\n  \"command\": \"" << command << "\",\n  \"exit_code\": " << code
                 << ",\n  \"error\": \"" << error.text() << "\"\n}\n")
        .write(STDOUT_FILENO);
  }
  ::_exit(status);
}

/// Ends the process, unless the program is writing its own answer, which may finish within kReaderMicroseconds.
void stop_now(int signal) {
  if (!last_word_taken.exchange(true)) {
    const char* what = signal == SIGALRM ? "out of time" : signal == SIGTERM ? "terminated" : "interrupted";
    const char* code = signal == SIGALRM ? "9" : signal == SIGTERM ? "143" : "130";
    end_now(ErrorText() << what << " in " << work.load() << "; the case can be resumed with the same command", code,
            code_of(signal));
  }
  if (last_word_said) return;
  std::int64_t until = 0;
  const std::int64_t time = now();
  if (reader_has_until.compare_exchange_strong(until, time + kReaderMicroseconds)) until = time + kReaderMicroseconds;
  if (time >= until) ::_exit(code_of(signal));
  set_timer(until - time);
}

/// The first signal requests a stop and starts a timer. A second signal, or the timer, ends the process at once.
void answer(int signal) {
  const bool is_timer = signal == SIGALRM;
  int first = 0;
  if (!asked_by.compare_exchange_strong(first, signal)) return stop_now(is_timer ? first : signal);
  if (last_word_taken) return stop_now(signal);
  if (!in_own_time) set_timer(kPatienceMicroseconds);
}

/// The kernel delivers a signal to any thread, and several signals to several threads. Each is forwarded to the
/// first thread. There it waits until the signal before has been answered (sa_mask), and the program's own answer
/// is written in this thread, too.
extern "C" void hear(int signal) {
  const int error = errno;
  if (::pthread_equal(::pthread_self(), first_thread)) {
    answer(signal);
  } else {
    ::pthread_kill(first_thread, signal);
  }
  errno = error;
}

/// Handles out-of-memory in noexcept functions: nlohmann's ordered_map and libstdc++'s directory_iterator allocate
/// in such functions.
[[noreturn]] void end_without_catcher() {
  try {
    if (const std::exception_ptr error = std::current_exception()) std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    const int status = static_cast<int>(ExitCode::ResourceLimit);
    const bool is_first = ::pthread_equal(::pthread_self(), first_thread);
    if (is_first && last_word_taken.exchange(true))
      ::_exit(status);  // this thread was writing the answer: there is no second answer
    if (!is_first) take_last_word();
    end_now(ErrorText() << "out of memory in " << work.load(), "9", status);
  } catch (...) {
  }
  if (other_end) other_end();  // the former handler prints the exception
  std::abort();
}

}  // namespace

void install_signal_handlers() {
  first_thread = ::pthread_self();
  other_end = std::set_terminate(end_without_catcher);
  struct sigaction action {};
  action.sa_handler = hear;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM, SIGALRM}) sigaddset(&action.sa_mask, signal);
  for (const int signal : {SIGINT, SIGTERM, SIGALRM}) ::sigaction(signal, &action, nullptr);
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
}

void stop_after(double seconds) {
  const double whole = std::floor(seconds);
  // A timer of zero would be disabled.
  const long rest = std::max(1L, static_cast<long>(1e6 * (seconds - whole)));
  const itimerval once{{0, 0}, {static_cast<time_t>(whole), rest}};
  ::setitimer(ITIMER_REAL, &once, nullptr);
}

void stop_in_own_time() { in_own_time = true; }

void answer_stops_in_json(const char* command) { answers_to = command; }

void take_last_word() {
  if (!last_word_taken.exchange(true)) return;
  for (;;) ::pause();  // until the answering thread ends the process
}

void say_no_more() { last_word_said = true; }

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
