#include "reconstruct/io/detail/clouds/pcd_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include "reconstruct/io/detail/text_rows.h"

namespace umtet::detail {
namespace {

/// The header line of one keyword.
struct Entry {
  std::size_t line = 0;
  std::vector<std::string_view> values;
};
using Entries = std::map<std::string_view, Entry>;

constexpr std::string_view kKeywords[] = {"VERSION", "FIELDS", "SIZE",      "TYPE",   "COUNT",
                                          "WIDTH",   "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};

Entries header_entries(const CloudSource& source, PcdHeader& header) {
  Entries entries;
  LineReader lines(source.bytes);
  std::string_view line;
  std::vector<std::string_view> tokens;
  while (lines.next_filled(line)) {
    split(line, " \t", tokens);
    if (tokens[0].starts_with('#')) continue;
    if (tokens[0] == "COLUMNS") tokens[0] = "FIELDS";  // its name before version 0.7
    const std::string_view keyword = tokens[0];
    if (std::find(std::begin(kKeywords), std::end(kKeywords), keyword) == std::end(kKeywords))
      refuse(source, fmt::format("line {}: {} is no line of a PCD header", lines.line(), in_quotes(line)));
    if (!entries.emplace(keyword, Entry{lines.line(), {tokens.begin() + 1, tokens.end()}}).second)
      refuse(source, fmt::format("line {}: {} is there twice", lines.line(), keyword));
    if (keyword == "DATA") {
      header.body = lines.offset();
      header.body_line = lines.line() + 1;
      return entries;
    }
  }
  refuse(source, "the header has no DATA line: the file is cut short or not PCD, export it again");
}

const Entry& required(const CloudSource& source, const Entries& entries, std::string_view keyword) {
  const auto found = entries.find(keyword);
  if (found == entries.end() || found->second.values.empty())
    refuse(source, fmt::format("the PCD header has no {}: export the file again", keyword));
  return found->second;
}

std::size_t parse_positive(const CloudSource& source, const Entry& entry, std::string_view keyword,
                           std::string_view token) {
  const std::optional<std::uint64_t> number = parse_count(token);
  if (!number || *number == 0)
    refuse(source, fmt::format("line {}: {} {}: expected a whole number > 0", entry.line, keyword, in_quotes(token)));
  return *number;
}

char parse_kind(const CloudSource& source, const Entry& types, std::string_view type, const PcdField& field) {
  const bool is_float = type == "F" && (field.size == 4 || field.size == 8);
  const bool is_integer =
      (type == "I" || type == "U") && (field.size == 1 || field.size == 2 || field.size == 4 || field.size == 8);
  if (!is_float && !is_integer)
    refuse(source, fmt::format("line {}: field {} has TYPE {} and SIZE {}: known are F 4 8, I and U 1 2 4 8",
                               types.line, in_quotes(field.name), in_quotes(type), field.size));
  return type[0];
}

void parse_fields(const CloudSource& source, const Entries& entries, PcdHeader& header) {
  const Entry& names = required(source, entries, "FIELDS");
  const Entry& sizes = required(source, entries, "SIZE");
  const Entry& types = required(source, entries, "TYPE");
  const std::size_t n = names.values.size();
  const auto same_length = [&](const Entry& entry, std::string_view keyword) {
    if (entry.values.size() != n)
      refuse(source,
             fmt::format("line {}: {} has {} values for {} fields", entry.line, keyword, entry.values.size(), n));
  };
  same_length(sizes, "SIZE");
  same_length(types, "TYPE");
  const auto counts = entries.find("COUNT");
  if (counts != entries.end()) same_length(counts->second, "COUNT");
  for (std::size_t f = 0; f < n; ++f) {
    PcdField field;
    field.name = names.values[f];
    field.size = parse_positive(source, sizes, "SIZE", sizes.values[f]);
    field.kind = parse_kind(source, types, types.values[f], field);
    if (counts != entries.end())
      field.count = parse_positive(source, counts->second, "COUNT", counts->second.values[f]);
    if (field.count > source.size())
      refuse(source, fmt::format("line {}: COUNT {} of field {} is larger than the file", counts->second.line,
                                 field.count, in_quotes(field.name)));
    header.fields.push_back(field);
  }
}

void parse_point_count(const CloudSource& source, const Entries& entries, PcdHeader& header) {
  const auto value = [&](std::string_view keyword) {
    const Entry& entry = required(source, entries, keyword);
    const std::optional<std::uint64_t> number = parse_count(entry.values[0]);
    // PCL, which wrote the file, counts points in 32 bits.
    if (!number || *number > std::numeric_limits<std::uint32_t>::max())
      refuse(source, fmt::format("line {}: {} {}: expected a whole number from 0 to 4294967295", entry.line, keyword,
                                 in_quotes(entry.values[0])));
    return *number;
  };
  header.n_points = value("POINTS");
  const std::uint64_t width = value("WIDTH"), height = value("HEIGHT");
  if (width * height != header.n_points)
    refuse(source, fmt::format("line {}: POINTS {} is not WIDTH {} x HEIGHT {}: the header is damaged, export the file "
                               "again",
                               required(source, entries, "POINTS").line, header.n_points, width, height));
}

/// Offsets of the fields and size of a point.
void lay_out(PcdHeader& header) {
  if (header.data == PcdData::Compressed) std::erase_if(header.fields, [](const PcdField& f) { return f.name == "_"; });
  for (PcdField& field : header.fields) {
    field.offset = header.point_bytes;
    header.point_bytes += field.size * field.count;  // <= 8 * file size per field: no overflow
  }
}

void check_size(const CloudSource& source, const PcdHeader& header) {
  const std::size_t point_bytes = header.point_bytes;
  const std::size_t left = source.size() - header.body;
  if (point_bytes == 0) refuse(source, "the PCD header has no fields but padding, so the file has no points");
  if (header.data == PcdData::Binary) {
    if (header.n_points > left / point_bytes)
      refuse(source, fmt::format("byte {}: {} points of {} bytes are announced but {} bytes are left: the file is cut "
                                 "short or the header is wrong, export it again",
                                 header.body, header.n_points, point_bytes, left));
    return;
  }
  if (source.bytes.size() - header.body < 8)
    refuse(source, fmt::format("byte {}: no compressed block follows: the file is cut short", header.body));
  std::uint32_t packed = 0, unpacked = 0;
  std::memcpy(&packed, source.bytes.data() + header.body, 4);
  std::memcpy(&unpacked, source.bytes.data() + header.body + 4, 4);
  if (packed > left - 8)
    refuse(source, fmt::format("byte {}: a compressed block of {} bytes is announced but {} are left: the file is cut "
                               "short, export it again",
                               header.body, packed, left - 8));
  // Three bytes of LZF stand for at most 264; PCL indexes the unpacked bytes with an int, so it wrote no more.
  constexpr std::uint64_t kLargestRatio = 88, kLargestBlock = std::numeric_limits<std::int32_t>::max();
  const bool fits = header.n_points <= kLargestBlock / point_bytes && unpacked == header.n_points * point_bytes &&
                    unpacked <= kLargestRatio * packed;
  if (!fits)
    refuse(source, fmt::format("byte {}: a compressed block of {} bytes is said to hold {} bytes for {} points of {} "
                               "bytes: the header is damaged, export the file again",
                               header.body + 4, packed, unpacked, header.n_points, point_bytes));
}

/// The line VIEWPOINT tx ty tz qw qx qy qz; what does not look like that tells nothing, and is no reason to refuse.
std::optional<Vec3> scanner_position(const Entries& entries) {
  const auto found = entries.find("VIEWPOINT");
  if (found == entries.end() || found->second.values.size() != 7) return std::nullopt;
  constexpr std::array<double, 7> kUnknown = {0, 0, 0, 1, 0, 0, 0};
  std::array<double, 7> pose;
  for (std::size_t k = 0; k < pose.size(); ++k) {
    const std::string_view token = found->second.values[k];
    const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), pose[k]);
    if (error != std::errc{} || end != token.data() + token.size() || !std::isfinite(pose[k])) return std::nullopt;
  }
  if (pose == kUnknown) return std::nullopt;
  return Vec3(pose[0], pose[1], pose[2]);
}

}  // namespace

PcdHeader parse_pcd_header(const CloudSource& source) {
  PcdHeader header;
  const Entries entries = header_entries(source, header);
  parse_fields(source, entries, header);
  parse_point_count(source, entries, header);
  header.viewpoint = scanner_position(entries);
  const Entry& data = required(source, entries, "DATA");
  if (data.values[0] == "ascii")
    header.data = PcdData::Ascii;
  else if (data.values[0] == "binary")
    header.data = PcdData::Binary;
  else if (data.values[0] == "binary_compressed")
    header.data = PcdData::Compressed;
  else
    refuse(source, fmt::format("line {}: DATA {}: known are ascii, binary, binary_compressed", data.line,
                               in_quotes(data.values[0])));
  lay_out(header);
  if (header.data != PcdData::Ascii) check_size(source, header);
  return header;
}

}  // namespace umtet::detail
