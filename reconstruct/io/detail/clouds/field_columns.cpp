#include "reconstruct/io/detail/clouds/field_columns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>

#include "reconstruct/io/point_cloud_io.h"

namespace umtet::detail {
namespace {

constexpr std::size_t kLongestName = 40;
constexpr std::array<std::string_view, 3> kColours = {"red", "green", "blue"};
// Of PCL's points vp_ is where the scanner stood, and "_" is padding.
constexpr std::string_view kReserved[] = {"x",        "y",        "z",        "nx",    "ny",   "nz",   "normal_x",
                                          "normal_y", "normal_z", "label",    "patch", "sx",   "sy",   "sz",
                                          "origin_x", "origin_y", "origin_z", "vp_x",  "vp_y", "vp_z", "rgb",
                                          "rgba",     "_",        kCount,     kSpread};

/// Without the C locale.
bool is_kept(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
}

std::string plain(std::string_view name) {
  std::string kept(name.substr(0, kLongestName));
  std::replace_if(
      kept.begin(), kept.end(), [](char c) { return !is_kept(c); }, '_');
  return kept;
}

std::uint8_t byte_of(double value) {
  return value > 0 ? static_cast<std::uint8_t>(std::lround(std::min(value, 255.))) : 0;  // NaN is not > 0
}

}  // namespace

bool is_reserved(std::string_view name) {
  return std::find(std::begin(kReserved), std::end(kReserved), name) != std::end(kReserved);
}

FieldColumns field_columns(const std::vector<std::string>& names) {
  FieldColumns columns;
  const auto place = [&](std::string_view name) {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  if (const std::size_t packed = place(kPackedColour); packed < names.size()) columns.colour = {packed};
  const std::array<std::size_t, 3> rgb = {place(kColours[0]), place(kColours[1]), place(kColours[2])};
  const bool has_rgb = std::all_of(rgb.begin(), rgb.end(), [&](std::size_t at) { return at < names.size(); });
  if (has_rgb) columns.colour = {rgb.begin(), rgb.end()};
  const std::array<std::size_t, 2> merged = {place(kCount), place(kSpread)};
  if (std::max(merged[0], merged[1]) < names.size()) columns.merged = {merged.begin(), merged.end()};
  const auto is_of_colour = [&](const std::string& name) {
    return (has_rgb && std::find(kColours.begin(), kColours.end(), name) != kColours.end()) ||
           (!columns.colour.empty() && name == "alpha");
  };
  for (std::size_t at = 0; at < names.size(); ++at) {
    if (names[at].find(' ') != std::string::npos || is_of_colour(names[at])) continue;
    const std::string name = plain(names[at]);
    if (is_reserved(name)) continue;
    const bool is_there = std::any_of(columns.scalars.begin(), columns.scalars.end(),
                                      [&](const FieldColumns::Scalar& s) { return s.name == name; });
    if (is_there || columns.scalars.size() == kMostFields) {
      columns.left_out.push_back(name);
    } else {
      columns.scalars.push_back({at, name});
    }
  }
  return columns;
}

std::vector<std::size_t> FieldColumns::wanted() const {
  std::vector<std::size_t> list = colour;
  list.insert(list.end(), merged.begin(), merged.end());
  for (const Scalar& scalar : scalars) list.push_back(scalar.at);
  return list;
}

void begin_fields(OrientedPointCloud& cloud, const FieldColumns& columns, std::size_t n) {
  if (!columns.colour.empty()) cloud.colours.reserve(n);
  if (!columns.merged.empty()) cloud.counts.reserve(n), cloud.spreads.reserve(n);
  for (const FieldColumns::Scalar& scalar : columns.scalars) {
    cloud.fields.push_back({scalar.name, {}});
    cloud.fields.back().values.reserve(n);
  }
}

void append_fields(OrientedPointCloud& cloud, const FieldColumns& columns, const std::vector<double>& values) {
  for (std::size_t f = 0; f < columns.scalars.size(); ++f) {
    cloud.fields[f].values.push_back(values[columns.scalars[f].at]);
  }
  if (!columns.merged.empty()) {
    const double count = values[columns.merged[0]];
    cloud.counts.push_back(count >= 1 && count <= std::numeric_limits<int>::max() ? static_cast<int>(count) : 0);
    cloud.spreads.push_back(values[columns.merged[1]]);
  }
  if (columns.colour.size() == 1) {
    const auto packed = static_cast<std::uint32_t>(values[columns.colour[0]]);
    cloud.colours.push_back({static_cast<std::uint8_t>(packed >> 16), static_cast<std::uint8_t>(packed >> 8),
                             static_cast<std::uint8_t>(packed)});
  } else if (columns.colour.size() == 3) {
    Colour& colour = cloud.colours.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) colour[k] = byte_of(columns.bytes_per_unit * values[columns.colour[k]]);
  }
}

}  // namespace umtet::detail
