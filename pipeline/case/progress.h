#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace umtet {

enum class ProgressMode { Auto, Plain, None };  ///< Auto: a bar on a terminal, else a line every few seconds
enum class Verbosity { Quiet, Normal, Verbose };

/// Talks to the user on stderr: lines, and how far the running stage is. Not thread-safe.
class Progress {
 public:
  Progress(ProgressMode mode, Verbosity verbosity);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void say(std::string_view line);     ///< unless quiet
  void detail(std::string_view line);  ///< if verbose
  void warn(std::string_view line);    ///< always

  /// Where the work stands; cheap enough for inner loops of milliseconds.
  /// @param fraction  of the whole stage, in [0, 1]
  /// @return false when a signal has asked to stop
  bool report(std::string_view stage, std::string_view step, double fraction);
  /// Clears the bar, if there is one.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  enum class Display { Bar, Lines, None };
  Display display_;
  Verbosity verbosity_;
  bool colour_;
  bool bar_is_drawn_ = false;
  Clock::time_point next_ = Clock::now();
};

}  // namespace umtet
