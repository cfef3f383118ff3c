// NRRD, as teem's format.txt of 2005 says it: a head of lines "field: value", an empty line, the data.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <map>

#include "reconstruct/io/detail/grids/grid_source.h"

namespace umtet::detail {
namespace {

using Fields = std::map<std::string, std::string, std::less<>>;

constexpr std::size_t kMostFields = 1000;

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

std::string lower(std::string_view text) {
  std::string made(text);
  std::transform(made.begin(), made.end(), made.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return made;
}

Fields read_fields(GridSource& source) {
  source.line();  // NRRD000n
  Fields fields;
  for (std::size_t n = 0;; ++n) {
    const std::string line = source.line();
    if (line.empty()) return fields;
    if (n == kMostFields) source.refuse("a head without an end");
    if (line.front() == '#') continue;
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos) source.refuse("a line of the head that is not FIELD: VALUE");
    if (colon + 1 < line.size() && line[colon + 1] == '=') continue;  // key:=value
    fields[lower(trimmed(std::string_view(line).substr(0, colon)))] = trimmed(std::string_view(line).substr(colon + 1));
  }
}

const std::string& wanted(const GridSource& source, const Fields& fields, const char* name) {
  const auto found = fields.find(name);
  if (found == fields.end()) source.refuse(std::string("the field '") + name + "' is missing");
  return found->second;
}

/// "(a,b,c)"
Vec3 vector_of(const GridSource& source, std::string_view text) {
  if (!text.starts_with('(') || !text.ends_with(')')) source.refuse(in_quotes(text) + " is not a vector (x,y,z)");
  text = text.substr(1, text.size() - 2);
  Vec3 v;
  for (int k = 0; k < 3; ++k) {
    const std::size_t comma = std::min(text.find(','), text.size());
    if ((comma == text.size()) != (k == 2)) source.refuse("a vector of other than three numbers");
    v[k] = number_of(source, trimmed(text.substr(0, comma)));
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return v;
}

void read_place(const GridSource& source, const Fields& fields, Grid& grid) {
  if (const auto at = fields.find("space directions"); at != fields.end()) {
    const std::vector<std::string_view> columns = words_of(at->second);
    if (columns.size() != 3) source.refuse("space directions: three vectors without blanks in them are wanted");
    for (int k = 0; k < 3; ++k) grid.axes.col(k) = vector_of(source, columns[static_cast<std::size_t>(k)]);
  } else if (const auto spacings = fields.find("spacings"); spacings != fields.end()) {
    const std::vector<std::string_view> steps = words_of(spacings->second);
    if (steps.size() != 3) source.refuse("spacings: three numbers are wanted");
    for (int k = 0; k < 3; ++k) grid.axes(k, k) = number_of(source, steps[static_cast<std::size_t>(k)]);
  }
  if (const auto at = fields.find("space origin"); at != fields.end()) grid.origin = vector_of(source, at->second);
}

}  // namespace

Grid read_nrrd(GridSource& source) {
  const Fields fields = read_fields(source);
  for (const char* name : {"data file", "datafile", "line skip", "lineskip", "byte skip", "byteskip"}) {
    const auto found = fields.find(name);
    if (found != fields.end() && found->second != "0") {
      source.refuse(std::string("'") + name +
                    "' is not read: the data must follow the head ('unu save -f nrrd' does that)");
    }
  }
  if (wanted(source, fields, "dimension") != "3") source.refuse("dimension: 3 is wanted, one number a node");
  const std::vector<std::string_view> sizes = words_of(wanted(source, fields, "sizes"));
  if (sizes.size() != 3) source.refuse("sizes: three numbers are wanted");
  std::vector<std::int64_t> n;
  for (const std::string_view size : sizes) n.push_back(count_of(source, size));
  const std::string& type_name = wanted(source, fields, "type");
  const std::optional<NumberType> type = number_type(type_name);
  if (!type) source.refuse("type: " + in_quotes(type_name) + " is no type of numbers");
  Grid grid;
  read_place(source, fields, grid);
  grid.is_whole = type->kind != NumberType::Kind::Float;
  const std::string encoding = lower(wanted(source, fields, "encoding"));
  const bool is_text = encoding == "ascii" || encoding == "text" || encoding == "txt";
  if (encoding == "gzip" || encoding == "gz") {
    source.unpack_rest();
  } else if (encoding != "raw" && !is_text) {
    source.refuse("encoding: " + in_quotes(encoding) + " is none of raw, gzip, ascii");
  }
  source.require_nodes(n, is_text ? kBytesOfWord : type->bytes);
  grid.n = {static_cast<int>(n[0]), static_cast<int>(n[1]), static_cast<int>(n[2])};
  if (is_text) {
    grid.values = source.take_words(grid.size());
    return grid;
  }
  bool swap = false;
  if (type->bytes > 1) {
    const std::string endian = lower(wanted(source, fields, "endian"));
    if (endian != "little" && endian != "big") source.refuse("endian: little or big is wanted");
    swap = (endian == "little") != (std::endian::native == std::endian::little);
  }
  grid.values = source.take_numbers(grid.size(), *type, swap);
  return grid;
}

}  // namespace umtet::detail
