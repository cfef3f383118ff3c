#include "pipeline/case/level_range.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string_view>

#include "pipeline/case/exit_code.h"
#include "pipeline/case/parameters.h"

namespace umtet {
namespace {

std::optional<double> number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double v = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), v);
  if (error != std::errc() || stop != text.data() + text.size() || !std::isfinite(v)) return std::nullopt;
  return v;
}

}  // namespace

std::optional<LevelRange> parse_level(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const std::string_view all = text;
  const std::size_t colon = all.find(':');
  const auto wrong = [&]() -> LevelRange {
    throw UsageError({Setting(Option{keys::mesh::level}, text),
                      ": give a number, or 300: for values above, :300 for values below, 200:500 for values between"});
  };
  if (colon == std::string_view::npos) {
    const std::optional<double> at = number(all);
    return at ? LevelRange{LevelRange::Side::Either, *at, *at} : wrong();
  }
  const std::string_view first = all.substr(0, colon), second = all.substr(colon + 1);
  const std::optional<double> low = number(first), high = number(second);
  if ((!low && !first.empty()) || (!high && !second.empty()) || (!low && !high)) return wrong();
  if (!high) return LevelRange{LevelRange::Side::Above, *low, *low};
  if (!low) return LevelRange{LevelRange::Side::Below, *high, *high};
  if (!(*low < *high)) return wrong();
  return LevelRange{LevelRange::Side::Between, *low, *high};
}

}  // namespace umtet
