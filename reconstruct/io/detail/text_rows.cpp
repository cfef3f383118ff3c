#include "reconstruct/io/detail/text_rows.h"

#include <fmt/format.h>

#include <charconv>
#include <limits>

namespace umtet::detail {

bool LineReader::next(std::string_view& line) {
  if (next_ >= bytes_.size()) return false;
  const std::size_t end = std::min(bytes_.find(end_, next_), bytes_.size());
  line = bytes_.substr(next_, end - next_);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  next_ = std::min(end + 1, bytes_.size());
  ++line_;
  return true;
}

bool LineReader::next_filled(std::string_view& line) {
  while (next(line))
    if (line.find_first_not_of(" \t") != std::string_view::npos) return true;
  return false;
}

void split(std::string_view line, std::string_view separators, std::vector<std::string_view>& tokens) {
  tokens.clear();
  std::size_t begin = line.find_first_not_of(separators);
  while (begin != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(separators, begin), line.size());
    tokens.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(separators, end);
  }
}

std::optional<std::uint64_t> parse_count(std::string_view token) {
  std::uint64_t count = 0;
  const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), count);
  if (error != std::errc() || end != token.data() + token.size()) return std::nullopt;
  return count;
}

double number_or_nan(std::string_view token) {
  double number = 0;
  const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), number);
  const bool is_number = error == std::errc() && end == token.data() + token.size();
  return is_number ? number : std::numeric_limits<double>::quiet_NaN();
}

double parse_number(const CloudSource& source, std::size_t line, std::string_view token) {
  std::string_view digits = token;
  // from_chars knows no plus sign; "+-1" must not become a number by removing it.
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  double number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error == std::errc::result_out_of_range)
    refuse(source, fmt::format("line {}: {} is outside the range of double precision", line, in_quotes(token)));
  if (error == std::errc() && end == digits.data() + digits.size()) return number;
  if (token.find(',') != std::string_view::npos)
    refuse(source, fmt::format("line {}: {} is not a number: if that is a decimal comma, export with decimal points",
                               line, in_quotes(token)));
  refuse(source, fmt::format("line {}: {} is not a number", line, in_quotes(token)));
}

}  // namespace umtet::detail
