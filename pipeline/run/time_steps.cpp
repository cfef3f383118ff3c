#include "pipeline/run/time_steps.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>

#include "pipeline/case/artefact.h"
#include "pipeline/case/exit_code.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

constexpr double kMostSteps = 100000;

double rounded(double t) { return std::strtod(fmt::format("{:.12g}", t).c_str(), nullptr) + 0.; }  // -0 becomes 0

double number(const std::string& text, const std::string& flag) {
  double t = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), t);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(t)) {
    throw UsageError(fmt::format("{}: \"{}\" is not a number", flag, text));
  }
  return rounded(t);
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, at);) parts.push_back(part);
  return parts;
}

std::vector<double> range(const std::string& text) {
  const std::vector<std::string> parts = split(text, ':');
  if (parts.size() != 3) throw UsageError("--t " + text + ": must be FROM:STEP:TO, such as 0:0.1:4.5");
  const double from = number(parts[0], "--t"), step = number(parts[1], "--t"), to = number(parts[2], "--t");
  if (!(step > 0) || to < from) throw UsageError("--t " + text + ": STEP must be > 0, and TO must not be before FROM");
  const double n = std::floor((to - from) / step * (1 + 1e-12) + 1e-9);
  if (!(n < kMostSteps)) throw UsageError(fmt::format("--t {}: more than {} steps", text, kMostSteps));
  std::vector<double> times;
  for (int k = 0; k <= static_cast<int>(n); ++k) times.push_back(rounded(from + k * step));
  if (std::adjacent_find(times.begin(), times.end(), std::greater_equal<>()) != times.end()) {
    throw UsageError("--t " + text + ": the steps are lost in rounding to 12 digits");
  }
  return times;
}

}  // namespace

std::vector<fs::path> listed_clouds(const fs::path& list) {
  constexpr std::size_t kLongestPath = 4096;  // Linux opens no longer path
  if (is_too_large_a_text(list))
    throw UsageError(list.string() + ": too large for a list of clouds with one path per line");
  std::vector<fs::path> clouds;
  for (std::string line : split(read_text(list), '\n')) {
    if (line.size() > kLongestPath)
      throw UsageError(list.string() + ": a line is longer than any path; give one path per line");
    // The path would end at this character, and may then be the path of a folder.
    if (line.find('\0') != std::string::npos)
      throw UsageError(list.string() + ": not a text file; give one path per line");
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back()))) line.pop_back();
    if (!line.empty() && line[0] != '#') clouds.push_back(fs::absolute(list).parent_path() / line);
  }
  if (clouds.empty()) throw UsageError(list.string() + " names no cloud; give one path per line");
  // A cloud given instead of a list has thousands of lines; a single missing file among others is reported separately.
  const auto is_there = [](const fs::path& cloud) {
    std::error_code unknown;
    return fs::exists(cloud, unknown);
  };
  if (std::none_of(clouds.begin(), clouds.end(), is_there)) {
    throw UsageError(
        fmt::format("{}: none of the {} files that it names exists (the first: {}); give a list "
                    "with one path of a cloud per line",
                    list.string(), clouds.size(), clouds.front().string()));
  }
  return clouds;
}

std::string time_text(double t) { return fmt::format("{}", t); }

std::vector<TimeStep> time_steps(const std::string& times, const std::string& skip, const fs::path& list) {
  if (times.empty() && list.empty()) throw UsageError("evolve: --t FROM:STEP:TO is missing");
  std::vector<TimeStep> steps;
  if (!times.empty()) {
    for (const double t : range(times)) steps.push_back({t, {}});
  }
  if (!list.empty()) {
    const std::vector<fs::path> clouds = listed_clouds(list);
    if (times.empty()) {
      for (std::size_t k = 0; k < clouds.size(); ++k) steps.push_back({static_cast<double>(k), {}});
    }
    if (clouds.size() != steps.size()) {
      throw UsageError(
          fmt::format("{} clouds in {}, and {} times in --t {}", clouds.size(), list.string(), steps.size(), times));
    }
    for (std::size_t k = 0; k < clouds.size(); ++k) steps[k].cloud = clouds[k];
  }
  for (const std::string& part : split(skip, ',')) {
    const double t = number(part, "--skip");
    if (std::erase_if(steps, [&](const TimeStep& s) { return s.t == t; }) == 0) {
      throw UsageError("--skip " + part + ": no such time");
    }
  }
  if (steps.empty()) throw UsageError("--skip leaves no time");
  return steps;
}

}  // namespace umtet
