#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace umtet {

enum class ProgressMode { Auto, Plain, None };  ///< Auto: a bar on a terminal, otherwise a line every few seconds
enum class Verbosity { Quiet, Normal, Verbose };

/// Prints messages and the progress of the running stage on stderr. Not thread-safe.
class Progress {
 public:
  Progress(ProgressMode mode, Verbosity verbosity);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void say(std::string_view line);     ///< prints the line unless quiet
  void detail(std::string_view line);  ///< prints the line if verbose
  void warn(std::string_view line);    ///< always prints the line

  /// Reports the progress of the work; cheap enough for inner loops of milliseconds.
  /// @param fraction  finished fraction of the stage, in [0, 1]
  /// @return false if a signal has requested a stop
  bool report(std::string_view stage, std::string_view step, double fraction);
  /// Clears the bar if it is drawn.
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
