#include <fmt/format.h>

#include <cstring>

#include "reconstruct/io/detail/cloud_source.h"
#include "reconstruct/io/detail/pcd_header.h"
#include "reconstruct/io/detail/pcd_unpack.h"
#include "reconstruct/io/detail/text_rows.h"

namespace umtet::detail {
namespace {

/// One name per field; fields with several values per point are no coordinates.
std::vector<std::string> scalar_names(const PcdHeader& header) {
  std::vector<std::string> names;
  for (const PcdField& field : header.fields) names.push_back(field.count == 1 ? field.name : "several " + field.name);
  return names;
}

double decode(const PcdField& field, const std::uint8_t* bytes) {
  const auto as = [bytes]<class T>(T value) {
    std::memcpy(&value, bytes, sizeof(T));
    return static_cast<double>(value);
  };
  const bool is_signed = field.kind == 'I';
  switch (field.size) {
    case 1:
      return is_signed ? as(std::int8_t{}) : as(std::uint8_t{});
    case 2:
      return is_signed ? as(std::int16_t{}) : as(std::uint16_t{});
    case 4:
      return field.kind == 'F' ? as(float{}) : is_signed ? as(std::int32_t{}) : as(std::uint32_t{});
    default:
      return field.kind == 'F' ? as(double{}) : is_signed ? as(std::int64_t{}) : as(std::uint64_t{});
  }
}

/// @param body  n_points * point_bytes bytes, little endian as all PCD
OrientedPointCloud decode_points(const CloudSource& source, const PcdHeader& header, const CloudColumns& columns,
                                 const std::uint8_t* body) {
  OrientedPointCloud cloud;
  cloud.points.reserve(header.n_points);
  if (columns.has_normals) cloud.normals.reserve(header.n_points);
  std::vector<double> values(header.fields.size());
  for (std::size_t i = 0; i < header.n_points; ++i) {
    for (const std::size_t c : columns)
      values[c] = decode(header.fields[c], body + i * header.point_bytes + header.fields[c].offset);
    append_point(source, cloud, values, columns);
  }
  return cloud;
}

/// Text is parsed here, not by PCL: PCL knows no line numbers.
OrientedPointCloud read_ascii(const CloudSource& source, const PcdHeader& header, const CloudColumns& columns) {
  std::vector<std::size_t> first_token;  // of each field
  std::size_t n_tokens = 0;
  for (const PcdField& field : header.fields) {
    first_token.push_back(n_tokens);
    n_tokens += field.count;
  }
  OrientedPointCloud cloud;
  LineReader lines(source.bytes, header.body, header.body_line);
  std::string_view line;
  std::vector<std::string_view> tokens;
  std::vector<double> values(header.fields.size());
  for (std::size_t i = 0; i < header.n_points; ++i) {
    if (!lines.next_filled(line))
      refuse(source, fmt::format("line {}: the file ends after {} of {} points: it is cut short, export it again",
                                 lines.line(), i, header.n_points));
    split(line, " \t", tokens);
    if (tokens.size() != n_tokens)
      refuse(source,
             fmt::format("line {}: {} values for point {} of {}, expected {}: the file is cut short or damaged, "
                         "export it again",
                         lines.line(), tokens.size(), i + 1, header.n_points, n_tokens));
    for (const std::size_t c : columns) values[c] = parse_number(source, lines.line(), tokens[first_token[c]]);
    append_point(source, cloud, values, columns);
  }
  refuse_surplus(source, lines.offset());
  return cloud;
}

}  // namespace

void check_pcd_head(const CloudSource& head) { cloud_columns(head, scalar_names(parse_pcd_header(head)), "field"); }

CloudFile read_pcd(const CloudSource& source) {
  const PcdHeader header = parse_pcd_header(source);
  const CloudColumns columns = cloud_columns(source, scalar_names(header), "field");
  switch (header.data) {
    case PcdData::Ascii:
      return {read_ascii(source, header, columns), {.format = "pcd ascii", .viewpoint = header.viewpoint}};
    case PcdData::Binary: {
      refuse_surplus(source, header.body + header.n_points * header.point_bytes);
      const auto* bytes = reinterpret_cast<const std::uint8_t*>(source.bytes.data());
      return {decode_points(source, header, columns, bytes + header.body),
              {.format = "pcd binary", .viewpoint = header.viewpoint}};
    }
    case PcdData::Compressed:
      break;
  }
  const std::vector<std::uint8_t> points = unpack(source, header);
  return {decode_points(source, header, columns, points.data()),
          {.format = "pcd compressed", .viewpoint = header.viewpoint}};
}

}  // namespace umtet::detail
