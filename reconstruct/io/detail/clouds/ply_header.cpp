#include "reconstruct/io/detail/clouds/ply_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "reconstruct/io/detail/text_rows.h"

namespace umtet::detail {
namespace {

constexpr std::pair<std::string_view, PlyType> kTypeNames[] = {
    {"char", PlyType::Int8},      {"uchar", PlyType::UInt8},    {"short", PlyType::Int16},
    {"ushort", PlyType::UInt16},  {"int", PlyType::Int32},      {"uint", PlyType::UInt32},
    {"float", PlyType::Float32},  {"double", PlyType::Float64}, {"int8", PlyType::Int8},
    {"uint8", PlyType::UInt8},    {"int16", PlyType::Int16},    {"uint16", PlyType::UInt16},
    {"int32", PlyType::Int32},    {"uint32", PlyType::UInt32},  {"float32", PlyType::Float32},
    {"float64", PlyType::Float64}};

constexpr std::pair<std::string_view, PlyFormat> kFormatNames[] = {
    {"ascii", PlyFormat::Ascii},
    {"binary_little_endian", PlyFormat::BinaryLittleEndian},
    {"binary_big_endian", PlyFormat::BinaryBigEndian}};

// Real files have a handful. Names are compared pair by pair, so a hostile header of millions would take hours.
constexpr std::size_t kMostElements = 100;

/// Line by line, with the state of what was met so far.
class HeaderParser {
 public:
  explicit HeaderParser(const CloudSource& source) : source_(source), lines_(source.bytes) {}

  PlyHeader parse() {
    std::string_view line;
    lines_.next(line);
    if (line != "ply") refuse(source_, "line 1: a PLY file starts with the line 'ply'");
    while (lines_.next(line)) {
      split(line, " \t", tokens_);
      if (tokens_.empty() || tokens_[0] == "comment" || tokens_[0] == "obj_info") continue;
      if (tokens_[0] == "end_header") return finish();
      if (tokens_[0] == "format")
        parse_format();
      else if (tokens_[0] == "element")
        parse_element();
      else if (tokens_[0] == "property")
        parse_property();
      else
        bad_line("is no line of a PLY header");
    }
    refuse(source_, "the header has no line 'end_header': the file is cut short or not PLY, export it again");
  }

 private:
  [[noreturn]] void bad_line(std::string_view what) {
    std::string line;
    for (const std::string_view token : tokens_) {
      if (!line.empty()) line += ' ';
      line += token.substr(0, 50);
    }
    refuse(source_, fmt::format("line {}: {} {}", lines_.line(), in_quotes(line), what));
  }

  void parse_format() {
    if (format_) bad_line("is the second format line");
    for (const auto& [name, format] : kFormatNames)
      if (tokens_.size() >= 2 && tokens_[1] == name) format_ = format;
    if (!format_) bad_line("is not one of the formats ascii, binary_little_endian, binary_big_endian");
  }

  void parse_element() {
    if (tokens_.size() != 3) bad_line("should be 'element NAME COUNT'");
    const std::optional<std::uint64_t> count = parse_count(tokens_[2]);
    if (!count) bad_line("has no count that is a whole number >= 0");
    if (header_.elements.size() == kMostElements) bad_line("is one element too many: this is no PLY of points");
    const auto same_name = [&](const PlyElement& e) { return e.name == tokens_[1]; };
    if (std::any_of(header_.elements.begin(), header_.elements.end(), same_name))
      bad_line("repeats an element: which of the two is meant is not known");
    header_.elements.push_back({std::string(tokens_[1]), *count, {}});
  }

  void parse_property() {
    if (header_.elements.empty()) bad_line("comes before any element");
    const bool is_list = tokens_.size() >= 2 && tokens_[1] == "list";
    if (tokens_.size() != (is_list ? 5 : 3))
      bad_line("should be 'property TYPE NAME' or 'property list TYPE TYPE NAME'");
    PlyProperty property;
    property.is_list = is_list;
    property.name = tokens_.back();
    property.type = parse_type(tokens_[is_list ? 3 : 1]);
    if (is_list) {
      property.count_type = parse_type(tokens_[2]);
      if (property.count_type == PlyType::Float32 || property.count_type == PlyType::Float64)
        bad_line("counts a list in fractions");
    }
    header_.elements.back().properties.push_back(property);
  }

  PlyType parse_type(std::string_view name) {
    for (const auto& [known, type] : kTypeNames)
      if (known == name) return type;
    bad_line(fmt::format("has the unknown type {}: known are char, short, int, their unsigned forms, float, double",
                         in_quotes(name)));
  }

  PlyHeader finish() {
    if (!format_) refuse(source_, "the header has no format line: export the file again");
    const auto is_vertex = [](const PlyElement& e) { return e.name == "vertex"; };
    if (std::none_of(header_.elements.begin(), header_.elements.end(), is_vertex))
      refuse(source_, "the header has no element 'vertex', so the file has no points");
    header_.format = *format_;
    header_.body = lines_.offset();
    header_.body_line = lines_.line() + 1;
    return std::move(header_);
  }

  const CloudSource& source_;
  LineReader lines_;
  std::vector<std::string_view> tokens_;
  std::optional<PlyFormat> format_;
  PlyHeader header_;
};

}  // namespace

std::size_t byte_size(PlyType type) {
  switch (type) {
    case PlyType::Int8:
    case PlyType::UInt8:
      return 1;
    case PlyType::Int16:
    case PlyType::UInt16:
      return 2;
    case PlyType::Int32:
    case PlyType::UInt32:
    case PlyType::Float32:
      return 4;
    case PlyType::Float64:
      return 8;
  }
  return 8;
}

PlyHeader parse_ply_header(const CloudSource& source) { return HeaderParser(source).parse(); }

}  // namespace umtet::detail
