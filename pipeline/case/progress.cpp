#include "pipeline/case/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "pipeline/case/interrupt.h"

namespace umtet {
namespace {

using namespace std::chrono_literals;
constexpr auto kBarPeriod = 100ms;  // faster updates flicker
constexpr auto kLinePeriod = 5s;    // people read log files
constexpr int kBarWidth = 30;

bool is_set(const char* name) {
  const char* value = std::getenv(name);
  return value && *value;
}

void put(const std::string& text) {
  // If stderr cannot be written, there is no way to report it.
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

}  // namespace

Progress::Progress(ProgressMode mode, Verbosity verbosity) : verbosity_(verbosity) {
  const char* terminal = std::getenv("TERM");
  const bool smart = ::isatty(STDERR_FILENO) && !(terminal && std::string_view(terminal) == "dumb");
  colour_ = smart && !is_set("NO_COLOR");
  display_ = mode == ProgressMode::None || verbosity == Verbosity::Quiet ? Display::None
             : mode == ProgressMode::Auto && smart                       ? Display::Bar
                                                                         : Display::Lines;
  // The first line is printed after one period: short stages print none.
  if (display_ == Display::Lines) next_ += kLinePeriod;
}

Progress::~Progress() { clear(); }

void Progress::say(std::string_view line) {
  if (verbosity_ != Verbosity::Quiet) warn(line);
}

void Progress::detail(std::string_view line) {
  if (verbosity_ == Verbosity::Verbose) warn(line);
}

void Progress::warn(std::string_view line) {
  clear();
  put(fmt::format("{}\n", line));
}

bool Progress::report(std::string_view stage, std::string_view step, double fraction) {
  const auto now = Clock::now();
  if (display_ != Display::None && now >= next_) {
    fraction = std::clamp(fraction, 0., 1.);
    if (display_ == Display::Bar) {
      const int filled = static_cast<int>(fraction * kBarWidth);
      put(fmt::format("\r{:<10}{}{:#<{}}{}{:-<{}} {:3.0f} %  {:<12}", stage, colour_ ? "\033[32m" : "", "", filled,
                      colour_ ? "\033[0m" : "", "", kBarWidth - filled, 100 * fraction, step));
      bar_is_drawn_ = true;
      next_ = now + kBarPeriod;
    } else {
      put(fmt::format("{}: {} {:.0f} %\n", stage, step, 100 * fraction));
      next_ = now + kLinePeriod;
    }
  }
  return interrupt_signal() == 0;
}

void Progress::clear() {
  if (bar_is_drawn_) put("\r\033[K");
  bar_is_drawn_ = false;
}

}  // namespace umtet
