#include "reconstruct/io/detail/clouds/text_dialect.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstring>

#include "reconstruct/io/detail/text_rows.h"

namespace umtet::detail {
namespace {

using Between = TextDialect::Between;

constexpr std::string_view kBlanks = " \t";

bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool begins_like_number(std::string_view line) {
  const char c = line[std::min(line.find_first_not_of(" \t\"'"), line.size() - 1)];
  return is_digit(c) || c == '-' || c == '+' || c == '.';
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  text = text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin);
  if (text.size() > 1 && text.front() == text.back() && (text.front() == '"' || text.front() == '\'')) {
    text.remove_prefix(1), text.remove_suffix(1);
  }
  return text;
}

/// Columns with one separator between two of them.
void split_at(std::string_view line, char separator, std::vector<std::string_view>& columns) {
  columns.clear();
  while (true) {
    const std::size_t end = std::min(line.find(separator), line.size());
    columns.push_back(trimmed(line.substr(0, end)));
    if (end == line.size()) return;
    line.remove_prefix(end + 1);
  }
}

/// The use of commas in a line.
struct Commas {
  bool any = false;
  bool all_decimal = true;  ///< each is alone in its word, between two digits
  bool has_point = false;   ///< a number has a point
};

Commas commas_of(const std::vector<std::string_view>& words) {
  Commas commas;
  for (const std::string_view word : words) {
    commas.has_point |= word.find('.') != std::string_view::npos;
    const std::size_t at = word.find(',');
    if (at == std::string_view::npos) continue;
    commas.any = true;
    commas.all_decimal &= at > 0 && at + 1 < word.size() && is_digit(word[at - 1]) && is_digit(word[at + 1]) &&
                          word.find(',', at + 1) == std::string_view::npos;
  }
  return commas;
}

TextDialect dialect_of_line(std::string_view line) {
  TextDialect dialect;
  std::vector<std::string_view> words;
  if (line.find(';') != std::string_view::npos) {
    dialect.between = Between::Semicolon;
    split_at(line, ';', words);
    const Commas commas = commas_of(words);
    dialect.decimal_comma = commas.any && commas.all_decimal && !commas.has_point;
    return dialect;
  }
  split(line, kBlanks, words);
  const Commas commas = commas_of(words);
  if (!commas.any) return dialect;
  if (words.size() > 1 && commas.all_decimal && !commas.has_point) {
    dialect.decimal_comma = true;
    return dialect;
  }
  split_at(line, ',', words);
  const bool has_inner_blanks = std::any_of(words.begin(), words.end(), [](std::string_view word) {
    return word.find_first_of(kBlanks) != std::string_view::npos;
  });
  dialect.between = has_inner_blanks ? Between::Mixed : Between::Comma;
  return dialect;
}

}  // namespace

TextDialect dialect_of(const std::vector<std::string_view>& lines, char end_of_line) {
  const bool has_numbers = std::any_of(lines.begin(), lines.end(), begins_like_number);
  constexpr std::size_t kKinds = 8;
  std::array<std::size_t, kKinds> votes{};
  for (const std::string_view line : lines) {
    if (has_numbers && !begins_like_number(line)) continue;
    const TextDialect of_line = dialect_of_line(line);
    ++votes[2 * static_cast<std::size_t>(of_line.between) + (of_line.decimal_comma ? 1 : 0)];
  }
  // Whole numbers show no decimal comma, so that one line with a comma speaks for all of its kind without one.
  for (const Between between : {Between::Blanks, Between::Semicolon}) {
    std::size_t* const of_kind = votes.data() + 2 * static_cast<std::size_t>(between);
    if (of_kind[1] > 0) of_kind[1] += of_kind[0];
  }
  const auto most = static_cast<std::size_t>(std::max_element(votes.begin(), votes.end()) - votes.begin());
  return {static_cast<Between>(most / 2), most % 2 == 1, end_of_line};
}

void split(std::string_view line, const TextDialect& dialect, std::vector<std::string_view>& columns) {
  switch (dialect.between) {
    case Between::Blanks:
      return split(line, kBlanks, columns);
    case Between::Mixed:
      return split(line, " \t,", columns);
    case Between::Comma:
      return split_at(line, ',', columns);
    case Between::Semicolon:
      return split_at(line, ';', columns);
  }
}

bool parse_number(std::string_view token, const TextDialect& dialect, double& number) {
  // from_chars knows no plus sign; "+-1" must not become a number by removing it.
  if (token.size() > 1 && token[0] == '+' && token[1] != '-') token.remove_prefix(1);
  std::array<char, 64> digits;  // a double has 24 characters
  if (dialect.decimal_comma) {
    // Where commas are decimal, nobody can tell whether "1.234" is more than a thousand.
    if (token.size() > digits.size() || token.find('.') != std::string_view::npos) return false;
    std::memcpy(digits.data(), token.data(), token.size());
    std::replace(digits.begin(), digits.begin() + static_cast<std::ptrdiff_t>(token.size()), ',', '.');
    token = {digits.data(), token.size()};
  }
  const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), number);
  return error == std::errc() && end == token.data() + token.size();
}

bool is_missing(std::string_view token) {
  if (token.empty()) return true;
  constexpr std::string_view kWords[] = {"na", "n/a", "null", "none", "-"};
  return std::any_of(std::begin(kWords), std::end(kWords), [&](std::string_view word) {
    return std::equal(token.begin(), token.end(), word.begin(), word.end(),
                      [](unsigned char a, char b) { return std::tolower(a) == b; });
  });
}

}  // namespace umtet::detail
