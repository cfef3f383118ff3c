#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace umtet {

/// A call of this same program, in a process of its own.
struct ChildCall {
  std::vector<std::string> arguments;          ///< without the name of the program
  std::filesystem::path standard_out, errors;  ///< files that are made or emptied; there is nothing on stdin
};

/// How a child ended.
struct ChildEnd {
  int exit_code = 0;  ///< that of exit(), or 0
  int signal = 0;     ///< that ended it, or 0
  double seconds = 0;
  double peak_memory_MB = 0;
};

/// Runs beside its parent, and is asked to stop (SIGTERM) when the parent ends, however that happens.
class ChildProcess {
 public:
  /// \pre the calling thread lives as long as the child; no other thread holds a lock that the child needs
  /// \throw std::system_error when there can be no further process
  explicit ChildProcess(const ChildCall& call);
  /// Kills and reaps a child that is still there.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// nullopt: it still runs. To be called again until it does not.
  std::optional<ChildEnd> poll();
  void send(int signal) const;
  double seconds() const;  ///< since it was started

 private:
  pid_t pid_ = -1;  ///< -1: reaped
  double start_;
};

}  // namespace umtet
