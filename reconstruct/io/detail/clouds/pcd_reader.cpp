#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "reconstruct/io/detail/byte_window.h"
#include "reconstruct/io/detail/clouds/cloud_columns.h"
#include "reconstruct/io/detail/clouds/cloud_readers.h"
#include "reconstruct/io/detail/clouds/pcd_header.h"
#include "reconstruct/io/detail/clouds/pcd_unpack.h"
#include "reconstruct/io/detail/text_rows.h"

namespace umtet::detail {
namespace {

/// A colour in the four bytes of a number: blue, green, red, alpha.
bool is_packed_colour(const PcdField& field) {
  return (field.name == "rgb" || field.name == "rgba") && field.size == 4 && field.count == 1;
}

/// One name per field; fields with several values per point are no coordinates.
std::vector<std::string> scalar_names(const PcdHeader& header) {
  std::vector<std::string> names;
  for (const PcdField& field : header.fields) {
    names.push_back(is_packed_colour(field) ? std::string(kPackedColour)
                    : field.count == 1      ? field.name
                                            : "several " + field.name);
  }
  return names;
}

CloudColumns columns_of(const CloudSource& source, const PcdHeader& header) {
  CloudColumns columns = cloud_columns(source, scalar_names(header), "field");
  // Colours in floating point are 0..1; of packed ones the bytes are taken.
  if (columns.fields.colour.size() == 3 && header.fields[columns.fields.colour.front()].kind == 'F')
    columns.fields.bytes_per_unit = 255;
  return columns;
}

/// As text it is the whole number, whatever its type, or the number in floating point that has these bytes. That is
/// below 1, negative or beyond 32 bits unless alpha is 63 to 79, which nobody writes.
double packed_colour(double number) {
  const bool is_whole =
      number >= 1 && number <= std::numeric_limits<std::uint32_t>::max() && number == std::trunc(number);
  if (is_whole) return number;
  const auto bytes = static_cast<float>(number);
  return std::isfinite(bytes) ? std::bit_cast<std::uint32_t>(bytes) : 0;
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
      if (is_packed_colour(field)) return as(std::uint32_t{});  // as a float some colours would be NaN
      return field.kind == 'F' ? as(float{}) : is_signed ? as(std::int32_t{}) : as(std::uint32_t{});
    default:
      return field.kind == 'F' ? as(double{}) : is_signed ? as(std::int64_t{}) : as(std::uint64_t{});
  }
}

/// @param bytes_of  a point's, point_bytes of them, little endian as all PCD
template <class BytesOf>
OrientedPointCloud decode_points(const CloudSource& source, const PcdHeader& header, const CloudColumns& columns,
                                 BytesOf&& bytes_of) {
  OrientedPointCloud cloud;
  begin_cloud(cloud, columns, header.n_points);
  std::vector<std::size_t> wanted = columns.fields.wanted();
  wanted.insert(wanted.end(), columns.begin(), columns.end());
  std::vector<double> values(header.fields.size());
  for (std::size_t i = 0; i < header.n_points; ++i) {
    const std::uint8_t* const bytes = bytes_of(i);
    for (const std::size_t c : wanted) values[c] = decode(header.fields[c], bytes + header.fields[c].offset);
    append_point(source, cloud, values, columns);
  }
  return cloud;
}

OrientedPointCloud read_binary(const CloudSource& source, const PcdHeader& header, const CloudColumns& columns) {
  ByteWindow bytes(source, header.body);
  OrientedPointCloud cloud = decode_points(source, header, columns, [&](std::size_t i) {
    if (const char* const point = bytes.take(header.point_bytes)) return reinterpret_cast<const std::uint8_t*>(point);
    refuse(source, fmt::format("byte {}: the file ends inside point {} of {}: it is cut short, export it again",
                               bytes.at(), i + 1, header.n_points));
  });
  bytes.refuse_surplus();
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
  begin_cloud(cloud, columns, 0);  // how many lines there are is not known
  const std::vector<std::size_t> of_fields = columns.fields.wanted();
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
    for (const std::size_t c : of_fields) {
      const double number = number_or_nan(tokens[first_token[c]]);
      values[c] = is_packed_colour(header.fields[c]) ? packed_colour(number) : number;
    }
    append_point(source, cloud, values, columns);
  }
  refuse_surplus(source, lines.offset());
  return cloud;
}

}  // namespace

void check_pcd_head(const CloudSource& head) { columns_of(head, parse_pcd_header(head)); }

bool is_in_blocks_pcd(const CloudSource& head) { return parse_pcd_header(head).data == PcdData::Binary; }

CloudFile read_pcd(const CloudSource& source) {
  const PcdHeader header = parse_pcd_header(source);
  const CloudColumns columns = columns_of(source, header);
  CloudFile file;
  file.report.viewpoint = header.viewpoint;
  file.report.fields_left_out = columns.fields.left_out;
  switch (header.data) {
    case PcdData::Ascii:
      file.report.format = "pcd ascii";
      file.cloud = read_ascii(source, header, columns);
      break;
    case PcdData::Binary:
      file.report.format = "pcd binary";
      file.cloud = read_binary(source, header, columns);
      break;
    case PcdData::Compressed:
      file.report.format = "pcd compressed";
      const std::vector<std::uint8_t> body = unpack(source, header);
      file.cloud =
          decode_points(source, header, columns, [&](std::size_t i) { return body.data() + i * header.point_bytes; });
  }
  return file;
}

}  // namespace umtet::detail
