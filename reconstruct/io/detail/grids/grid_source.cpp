#include "reconstruct/io/detail/grids/grid_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <map>

namespace umtet::detail {
namespace {

constexpr std::size_t kPiece = 1 << 16;  // bytes that become numbers at once

[[noreturn]] void refuse_grid(const std::string& name, const std::string& what) {
  throw GridRefused(name + ": " + what);
}

}  // namespace

std::optional<NumberType> number_type(std::string_view name) {
  using Kind = NumberType::Kind;
  static const std::map<std::string, NumberType, std::less<>> kTypes = {{"char", {Kind::Signed, 1}},
                                                                        {"signed char", {Kind::Signed, 1}},
                                                                        {"int8", {Kind::Signed, 1}},
                                                                        {"int8_t", {Kind::Signed, 1}},
                                                                        {"unsigned char", {Kind::Unsigned, 1}},
                                                                        {"unsigned_char", {Kind::Unsigned, 1}},
                                                                        {"uchar", {Kind::Unsigned, 1}},
                                                                        {"uint8", {Kind::Unsigned, 1}},
                                                                        {"uint8_t", {Kind::Unsigned, 1}},
                                                                        {"short", {Kind::Signed, 2}},
                                                                        {"short int", {Kind::Signed, 2}},
                                                                        {"signed short", {Kind::Signed, 2}},
                                                                        {"signed short int", {Kind::Signed, 2}},
                                                                        {"int16", {Kind::Signed, 2}},
                                                                        {"int16_t", {Kind::Signed, 2}},
                                                                        {"ushort", {Kind::Unsigned, 2}},
                                                                        {"unsigned short", {Kind::Unsigned, 2}},
                                                                        {"unsigned_short", {Kind::Unsigned, 2}},
                                                                        {"unsigned short int", {Kind::Unsigned, 2}},
                                                                        {"uint16", {Kind::Unsigned, 2}},
                                                                        {"uint16_t", {Kind::Unsigned, 2}},
                                                                        {"int", {Kind::Signed, 4}},
                                                                        {"signed int", {Kind::Signed, 4}},
                                                                        {"int32", {Kind::Signed, 4}},
                                                                        {"int32_t", {Kind::Signed, 4}},
                                                                        {"uint", {Kind::Unsigned, 4}},
                                                                        {"unsigned int", {Kind::Unsigned, 4}},
                                                                        {"unsigned_int", {Kind::Unsigned, 4}},
                                                                        {"uint32", {Kind::Unsigned, 4}},
                                                                        {"uint32_t", {Kind::Unsigned, 4}},
                                                                        {"longlong", {Kind::Signed, 8}},
                                                                        {"long long", {Kind::Signed, 8}},
                                                                        {"long", {Kind::Signed, 8}},
                                                                        {"vtktypeint64", {Kind::Signed, 8}},
                                                                        {"vtkidtype", {Kind::Signed, 8}},
                                                                        {"int64", {Kind::Signed, 8}},
                                                                        {"int64_t", {Kind::Signed, 8}},
                                                                        {"ulonglong", {Kind::Unsigned, 8}},
                                                                        {"unsigned long long", {Kind::Unsigned, 8}},
                                                                        {"unsigned_long", {Kind::Unsigned, 8}},
                                                                        {"vtktypeuint64", {Kind::Unsigned, 8}},
                                                                        {"uint64", {Kind::Unsigned, 8}},
                                                                        {"uint64_t", {Kind::Unsigned, 8}},
                                                                        {"float", {Kind::Float, 4}},
                                                                        {"float32", {Kind::Float, 4}},
                                                                        {"double", {Kind::Float, 8}},
                                                                        {"float64", {Kind::Float, 8}}};
  std::string lower(name.substr(0, 40));
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  const auto found = kTypes.find(lower);
  return found == kTypes.end() ? std::nullopt : std::optional(found->second);
}

GridSource::GridSource(const std::filesystem::path& file, double max_nodes, Part part)
    : ByteStream(file, refuse_grid), max_nodes_(max_nodes), part_(part) {}

GridSource::GridSource(const InputFile& file, double max_nodes, Part part)
    : ByteStream(file.descriptor(), file.path(), refuse_grid), max_nodes_(max_nodes), part_(part) {}

void GridSource::require_nodes(const std::vector<std::int64_t>& counts, double bytes_each) {
  double n = 1;
  for (const std::int64_t count : counts) {
    if (count < 1 || count > std::numeric_limits<int>::max()) refuse("a number of nodes that is none");
    n *= static_cast<double>(count);
  }
  if (n * bytes_each > most_bytes()) refuse(fmt::format("{:.4g} nodes: the file has no room for so many", n));
  if (n > max_nodes_) {
    refuse(
        fmt::format("{:.4g} nodes, and at most {:.4g} are allowed: take every second one, or a part", n, max_nodes_));
  }
  if (part_ == Part::Head) throw EndOfHead();
}

std::vector<double> GridSource::take_numbers(std::uint64_t n, NumberType type, bool swap) {
  std::vector<double> numbers;
  const std::uint64_t at_once = kPiece / 8;
  while (numbers.size() < n) {
    append_numbers(take(std::min(at_once, n - numbers.size()) * static_cast<std::uint64_t>(type.bytes)), type, swap,
                   numbers);
  }
  return numbers;
}

std::vector<double> GridSource::take_words(std::uint64_t n) {
  std::vector<double> numbers;
  const auto take = [&](std::string_view word) {
    numbers.push_back(number_of(*this, word));
    return numbers.size() < n;
  };
  if (n > 0 && !words(take)) refuse(fmt::format("the file is cut: {} numbers are missing", n - numbers.size()));
  return numbers;
}

double number_of(const GridSource& source, std::string_view word) {
  double value = 0;
  const char* const begin = word.data() + (word.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) source.refuse(in_quotes(word) + " is not a number");
  return value;
}

std::int64_t count_of(const GridSource& source, std::string_view word) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size())
    source.refuse(in_quotes(word) + " is not a whole number");
  return value;
}

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; at < text.size();) {
    while (at < text.size() && is_blank(text[at])) ++at;
    std::size_t end = at;
    while (end < text.size() && !is_blank(text[end])) ++end;
    if (end > at) words.push_back(text.substr(at, end - at));
    at = end;
  }
  return words;
}

}  // namespace umtet::detail
