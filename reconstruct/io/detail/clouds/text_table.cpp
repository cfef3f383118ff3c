#include "reconstruct/io/detail/clouds/text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <utility>

#include "reconstruct/io/detail/text_rows.h"

namespace umtet::detail {
namespace {

// Lines that show the dialect: decimal commas show in the first coordinate that is no whole number.
constexpr std::size_t kLinesOfDialect = 256;
// Lines of words before the rows: title, date, instrument, units. Headers of scanners have up to a dozen.
constexpr std::size_t kMostWords = 32;
// Rows for a guess: columns are told apart in the first hundred; places of a scan differ in intensity and colour.
constexpr std::size_t kFirstRows = 1024, kPlaces = 48, kRowsOfPlace = 64;
constexpr std::size_t kFewestColumns = 3;

std::string_view without_blanks(std::string_view line) {
  const std::size_t begin = line.find_first_not_of(" \t");
  return begin == std::string_view::npos ? std::string_view() : line.substr(begin);
}

/// The byte order mark of UTF-8 is stepped over.
std::size_t first_byte(const CloudSource& source) {
  if (source.bytes.starts_with("\xff\xfe") || source.bytes.starts_with("\xfe\xff"))
    refuse(source, "line 1: a text in UTF-16: save it as UTF-8 or ASCII");
  return source.bytes.starts_with("\xef\xbb\xbf") ? 3 : 0;
}

std::string lower_case(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return std::tolower(c); });
  return out;
}

char end_of_line(std::string_view bytes) {
  return bytes.find('\n') == std::string_view::npos && bytes.find('\r') != std::string_view::npos ? '\r' : '\n';
}

void require_text(const CloudSource& source, std::size_t line, std::string_view text) {
  if (text.size() > kLongestLine)
    refuse(source, fmt::format("line {}: {} bytes long: this is no text with a point a line", line, text.size()));
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < ' ' && c != '\t' && c != '\r'; };
  if (std::any_of(text.begin(), text.end(), is_control))
    refuse(source, fmt::format("line {}: bytes that are no text: this is no table of points", line));
}

std::vector<std::string_view> lines_of_dialect(const CloudSource& source, std::size_t begin, char end) {
  std::vector<std::string_view> lines;
  LineReader reader(source.bytes, begin, 1, end);
  std::string_view line;
  while (lines.size() < kLinesOfDialect && reader.next_filled(line)) {
    if (line.size() <= kLongestLine && !is_comment(line)) lines.push_back(line);
  }
  return lines;
}

std::size_t n_numbers(const std::vector<std::string_view>& tokens, const TextDialect& dialect) {
  double number = 0;
  return static_cast<std::size_t>(std::count_if(
      tokens.begin(), tokens.end(), [&](std::string_view token) { return parse_number(token, dialect, number); }));
}

/// Leaves out a comment behind the first n columns.
void cut_comment(std::size_t n, std::vector<std::string_view>& columns) {
  for (std::size_t c = n; c < columns.size(); ++c) {
    if (is_comment(columns[c])) return columns.resize(c);
  }
}

/// Words that may name columns, however they are separated: those of the comment of a table with commas have blanks.
std::vector<std::vector<std::string>> readings_of_header(std::string_view line, const TextDialect& dialect) {
  line = without_blanks(line);
  if (is_comment(line)) line.remove_prefix(std::min(line.find_first_not_of("#/%"), line.size()));
  std::vector<std::vector<std::string>> readings;
  std::vector<std::string_view> words;
  const auto add = [&] {
    if (words.size() > 1 && words.back().empty()) words.pop_back();
    std::vector<std::string>& names = readings.emplace_back();
    for (const std::string_view word : words) names.push_back(column_name(word));
  };
  split(without_blanks(line), dialect, words);
  add();
  split(line, " \t,;", words);
  for (std::string_view& word : words) {
    if (word.size() > 1 && word.front() == '"' && word.back() == '"') word = word.substr(1, word.size() - 2);
  }
  add();
  return readings;
}

/// Reads what stands before the rows.
class Beginning {
 public:
  explicit Beginning(const CloudSource& source) : source_(source) {}

  TextTable operator()() {
    const std::size_t begin = first_byte(source_);
    const char end = end_of_line(source_.bytes.substr(0, kLongestLine));
    lines_ = lines_of_dialect(source_, begin, end);
    table_.dialect = dialect_of(lines_, end);
    LineReader lines(source_.bytes, begin, 1, end);
    std::string_view line;
    std::size_t at = begin;
    while (lines.next(line)) {
      if (!without_blanks(line).empty() && is_row(line, lines.line())) {
        table_.begin = at;
        table_.first_line = lines.line();
        take_header();
        return std::move(table_);
      }
      at = lines.offset();
    }
    refuse_words(1);
  }

 private:
  struct Words {
    std::size_t line = 0;
    bool is_comment = false;
    std::vector<std::vector<std::string>> readings;
  };

  bool is_row(std::string_view line, std::size_t number) {
    require_text(source_, number, line);
    if (is_comment(line)) {
      words_.push_back({number, true, readings_of_header(line, table_.dialect)});
      return false;
    }
    split(line, table_.dialect, tokens_);
    if (tokens_.size() == 1 && !table_.announced && (table_.announced = parse_count(tokens_.front()))) return false;
    cut_comment(kFewestColumns, tokens_);
    if (n_numbers(tokens_, table_.dialect) >= kFewestColumns) {
      table_.n_columns = tokens_.size();
      if (ends_behind_columns()) --table_.n_columns;
      return true;
    }
    if (lower_case(tokens_.front()) == "ncols")
      refuse(source_, fmt::format("line {}: a grid of heights (ESRI), not a table of points: write it as points x y z, "
                                  "for example with 'gdal_translate -of XYZ'",
                                  number));
    double first = 0;
    if (parse_number(tokens_.front(), table_.dialect, first)) refuse_row(number);
    if (++n_words_ > kMostWords) refuse_words(words_.front().line);
    words_.push_back({number, false, readings_of_header(line, table_.dialect)});
    return false;
  }

  /// @return the rows end with a separator: no row has a column behind it
  bool ends_behind_columns() const {
    if (!tokens_.back().empty()) return false;
    std::vector<std::string_view> tokens;
    return std::all_of(lines_.begin(), lines_.end(), [&](std::string_view line) {
      split(line, table_.dialect, tokens);
      return tokens.size() != table_.n_columns || tokens.back().empty() || n_numbers(tokens, table_.dialect) == 0;
    });
  }

  [[noreturn]] void refuse_row(std::size_t line) const {
    if (tokens_.size() < kFewestColumns)
      refuse(source_, fmt::format("line {}: {} column{}: a point needs x, y and z", line, tokens_.size(),
                                  tokens_.size() == 1 ? "" : "s"));
    double number = 0;
    const auto bad = std::find_if(tokens_.begin(), tokens_.end(),
                                  [&](std::string_view token) { return !parse_number(token, table_.dialect, number); });
    refuse(source_, fmt::format("line {}, column {}: {} is not a number: a row is x y z and what else belongs to the "
                                "point",
                                line, bad - tokens_.begin() + 1, in_quotes(*bad)));
  }

  [[noreturn]] void refuse_words(std::size_t line) const {
    refuse(source_, fmt::format("line {}: no row of three or more numbers in the {} lines of words from here on: this "
                                "is no table of points",
                                line, n_words_));
  }

  /// The last line that names the columns. A header that does not fit the rows is none to guess without.
  void take_header() {
    for (auto words = words_.rbegin(); words != words_.rend(); ++words) {
      for (std::vector<std::string>& names : words->readings) {
        if (!has_axes(names) || names.size() != table_.n_columns) continue;
        table_.header = std::move(names);
        table_.n_ignored = n_words_ - (words->is_comment ? 0 : 1);
        return;
      }
    }
    table_.n_ignored = n_words_;
    for (const Words& words : words_) {
      if (words.is_comment || source_.columns.size() > 0 || !has_axes(words.readings.front())) continue;
      refuse(source_, {fmt::format("line {}: a header of {} names, but line {} has {} columns", words.line,
                                   words.readings.front().size(), table_.first_line, table_.n_columns),
                       {{Change::Give, kColumns, "to name them, such as x,y,z"}}});
    }
  }

  const CloudSource& source_;
  TextTable table_;
  std::vector<std::string_view> lines_;  ///< the first ones, without comments
  std::vector<Words> words_;
  std::vector<std::string_view> tokens_;
  std::size_t n_words_ = 0;  ///< lines of words that are no comments
};

}  // namespace

TextTable find_table(const CloudSource& source) { return Beginning(source)(); }

bool is_table(const CloudSource& source) {
  try {
    return find_table(source).n_ignored == 0;
  } catch (const CloudRefused&) {
    return false;
  }
}

bool is_comment(std::string_view line) {
  line = without_blanks(line);
  return line.starts_with('#') || line.starts_with('%') || line.starts_with("//");
}

std::size_t split_row(std::string_view line, const TextTable& table, std::vector<std::string_view>& columns) {
  split(line, table.dialect, columns);
  const std::size_t n = table.n_columns;
  if (columns.size() > n && is_comment(columns[n])) columns.resize(n);
  if (columns.size() == n + 1 && columns.back().empty()) columns.pop_back();
  return columns.size();
}

SampleRows sample_rows(const CloudSource& source, const TextTable& table) {
  SampleRows rows;
  rows.n_columns = table.n_columns;
  std::vector<std::string_view> tokens;
  const auto read = [&](std::size_t from, std::size_t most) {
    LineReader lines(source.bytes, from, 1, table.dialect.end_of_line);
    std::string_view line;
    for (std::size_t r = 0; r < most && lines.next_filled(line); ++r) {
      if (line.size() > kLongestLine || split_row(line, table, tokens) != table.n_columns || is_comment(line)) continue;
      for (const std::string_view token : tokens) {
        double number = 0;
        rows.values.push_back(parse_number(token, table.dialect, number) ? number
                                                                         : std::numeric_limits<double>::quiet_NaN());
      }
    }
    return lines.offset();
  };
  std::size_t done = read(table.begin, kFirstRows);
  rows.n_first = rows.n_rows();
  const std::size_t size = source.bytes.size() - table.begin;
  for (std::size_t p = 1; p < kPlaces; ++p) {
    const std::size_t place = table.begin + size / kPlaces * p;
    std::size_t from = done;
    if (place > done) {
      const std::size_t end = source.bytes.find(table.dialect.end_of_line, place);
      if (end == std::string_view::npos) break;
      from = end + 1;
    }
    done = read(from, kRowsOfPlace);
  }
  return rows;
}

}  // namespace umtet::detail
