#pragma once

#include <cstdio>
#include <string>

namespace umtet::test {

/// Output of a program, with its exit code as last line.
inline std::string shell(const std::string& command) {
  std::string out;
  FILE* pipe = popen((command + " 2>&1; echo exit $?").c_str(), "r");
  char buffer[4096];
  while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, pipe)) out.append(buffer, n);
  pclose(pipe);
  return out;
}

inline bool succeeds(const std::string& command) { return shell(command).ends_with("exit 0\n"); }

inline constexpr const char* kPython = "/usr/bin/python3";  ///< Debian's, where python3-meshio is installed

}  // namespace umtet::test
