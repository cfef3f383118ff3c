#include "pipeline/cli/child_process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <system_error>

namespace umtet {
namespace {

// The executable of this process, even if another file has been installed under its name meanwhile.
constexpr const char* kThisProgram = "/proc/self/exe";
constexpr int kCannotStart = 127;  // as in shells

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Runs between fork and exec, so it makes only calls that are safe in a signal handler.
[[noreturn]] void become(const ChildCall& call, char* const* argv, pid_t parent, const sigset_t& mask) {
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != parent) ::_exit(kCannotStart);  // the parent ended before the line above
  for (const int signal : {SIGINT, SIGTERM, SIGALRM}) ::signal(signal, SIG_DFL);
  ::sigprocmask(SIG_SETMASK, &mask, nullptr);
  const auto redirect = [](int target, const char* file, int flags) {
    const int fd = ::open(file, flags, 0666);
    if (fd < 0 || ::dup2(fd, target) < 0) ::_exit(kCannotStart);
    if (fd != target) ::close(fd);
  };
  redirect(STDERR_FILENO, call.errors.c_str(), O_WRONLY | O_CREAT | O_TRUNC);
  redirect(STDIN_FILENO, "/dev/null", O_RDONLY);
  redirect(STDOUT_FILENO, call.standard_out.c_str(), O_WRONLY | O_CREAT | O_TRUNC);
  ::execv(kThisProgram, argv);
  ::_exit(kCannotStart);
}

}  // namespace

ChildProcess::ChildProcess(const ChildCall& call) : start_(now()) {
  std::vector<char*> argv;
  std::string name = "umtet";
  argv.push_back(name.data());
  for (const std::string& argument : call.arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const pid_t parent = ::getpid();
  // Before exec, our own handler would take a signal, and the signal would be lost.
  sigset_t all, mask;
  ::sigfillset(&all);
  ::sigprocmask(SIG_SETMASK, &all, &mask);
  pid_ = ::fork();
  if (pid_ == 0) become(call, argv.data(), parent, mask);
  const int code = errno;
  ::sigprocmask(SIG_SETMASK, &mask, nullptr);
  if (pid_ < 0) throw std::system_error(code, std::generic_category(), "cannot start a process");
}

ChildProcess::~ChildProcess() {
  if (pid_ < 0) return;
  ::kill(pid_, SIGKILL);
  while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

std::optional<ChildEnd> ChildProcess::poll() {
  int status = 0;
  rusage usage{};
  const pid_t ended = ::wait4(pid_, &status, WNOHANG, &usage);
  if (ended == 0 || (ended < 0 && errno == EINTR)) return std::nullopt;
  if (ended < 0) throw std::system_error(errno, std::generic_category(), "cannot wait for a process");
  pid_ = -1;
  ChildEnd end;
  if (WIFSIGNALED(status)) {
    end.signal = WTERMSIG(status);
  } else {
    end.exit_code = WEXITSTATUS(status);
  }
  end.seconds = seconds();
  end.peak_memory_MB = static_cast<double>(usage.ru_maxrss) / 1024;  // Linux reports KiB
  return end;
}

void ChildProcess::send(int signal) const {
  if (pid_ > 0) ::kill(pid_, signal);
}

double ChildProcess::seconds() const { return now() - start_; }

}  // namespace umtet
