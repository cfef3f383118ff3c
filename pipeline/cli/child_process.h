#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace umtet {

/// A call of this program in a separate process.
struct ChildCall {
  std::vector<std::string> arguments;          ///< arguments without the program name
  std::filesystem::path standard_out, errors;  ///< files that are created or truncated; stdin is empty
};

/// How a child ended.
struct ChildEnd {
  int exit_code = 0;  ///< argument of exit(), or 0
  int signal = 0;     ///< signal that ended the process, or 0
  double seconds = 0;
  double peak_memory_MB = 0;
};

/// A process that runs in parallel with its parent. It receives SIGTERM when the parent ends for any reason.
class ChildProcess {
 public:
  /// \pre the calling thread lives as long as the child; no other thread holds a lock that the child needs
  /// \throw std::system_error if no further process can be started
  explicit ChildProcess(const ChildCall& call);
  /// Kills and reaps the child if it still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Returns how the child ended, or nullopt while it still runs. Do not call it again after the child has ended.
  std::optional<ChildEnd> poll();
  void send(int signal) const;
  double seconds() const;  ///< seconds since the start

 private:
  pid_t pid_ = -1;  ///< -1: reaped
  double start_;
};

}  // namespace umtet
