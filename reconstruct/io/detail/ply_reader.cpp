// Our own reader, because the libraries at hand lose data or die on what is out there: PCL 1.13 reads coordinates
// stored as double (what Open3D writes) as zeros and reports success, and it aborts on a vertex count it cannot
// allocate; OpenMesh 9 takes a cut ascii body for a whole one; VTK 9.1 crashes on wrong list lengths.

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "reconstruct/io/detail/cloud_source.h"
#include "reconstruct/io/detail/ply_header.h"
#include "reconstruct/io/detail/text_rows.h"

namespace umtet::detail {
namespace {

template <class T>
double decode_as(const char* bytes, bool swap) {
  std::array<char, sizeof(T)> buffer;
  std::memcpy(buffer.data(), bytes, sizeof(T));
  if (swap) std::reverse(buffer.begin(), buffer.end());
  return static_cast<double>(std::bit_cast<T>(buffer));
}

/// Every PLY type fits a double exactly.
double decode(PlyType type, const char* bytes, bool swap) {
  switch (type) {
    case PlyType::Int8:
      return decode_as<std::int8_t>(bytes, swap);
    case PlyType::UInt8:
      return decode_as<std::uint8_t>(bytes, swap);
    case PlyType::Int16:
      return decode_as<std::int16_t>(bytes, swap);
    case PlyType::UInt16:
      return decode_as<std::uint16_t>(bytes, swap);
    case PlyType::Int32:
      return decode_as<std::int32_t>(bytes, swap);
    case PlyType::UInt32:
      return decode_as<std::uint32_t>(bytes, swap);
    case PlyType::Float32:
      return decode_as<float>(bytes, swap);
    case PlyType::Float64:
      break;
  }
  return decode_as<double>(bytes, swap);
}

std::string place_of(const PlyElement& element, std::uint64_t item) {
  return fmt::format("{} {} of {}", element.name, item + 1, element.count);
}

/// Reads items one after the other; values get one number per property (a list gives its length, its content is
/// stepped over).
class BinaryBody {
 public:
  BinaryBody(const CloudSource& source, const PlyHeader& header)
      : source_(source),
        at_(header.body),
        swap_((header.format == PlyFormat::BinaryBigEndian) != (std::endian::native == std::endian::big)) {}

  /// The least an item takes.
  static std::size_t bytes_per_item(const PlyElement& element) {
    std::size_t bytes = 0;
    for (const PlyProperty& p : element.properties) bytes += byte_size(p.is_list ? p.count_type : p.type);
    return bytes;
  }
  std::size_t bytes_left() const { return source_.size() - at_; }
  std::string place() const { return fmt::format("byte {}", at_); }

  void read_item(const PlyElement& element, std::uint64_t item, std::vector<double>& values) {
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (!property.is_list) {
        values[p] = decode(property.type, take(byte_size(property.type), element, item), swap_);
        continue;
      }
      values[p] = decode(property.count_type, take(byte_size(property.count_type), element, item), swap_);
      if (values[p] < 0)
        refuse(source_, fmt::format("{}, {}: a list of negative length", place(), place_of(element, item)));
      // Length <= 2^32 - 1 and size <= 8: no overflow.
      take(static_cast<std::size_t>(values[p]) * byte_size(property.type), element, item);
    }
  }

  void finish() { refuse_surplus(source_, at_); }

 private:
  const char* take(std::size_t n, const PlyElement& element, std::uint64_t item) {
    if (n > bytes_left())
      refuse(source_, fmt::format("{}: the file ends inside {}: it is cut short or a list length is wrong, export it "
                                  "again",
                                  place(), place_of(element, item)));
    const char* bytes = source_.bytes.data() + at_;
    at_ += n;
    return bytes;
  }

  const CloudSource& source_;
  std::size_t at_;
  bool swap_;
};

/// The same for text: one item per line.
class AsciiBody {
 public:
  AsciiBody(const CloudSource& source, const PlyHeader& header)
      : source_(source), lines_(source.bytes, header.body, header.body_line) {}

  static std::size_t bytes_per_item(const PlyElement& element) { return 2 * element.properties.size(); }
  /// The last line may lack its end.
  std::size_t bytes_left() const { return source_.size() - lines_.offset() + 1; }
  std::string place() const { return fmt::format("line {}", lines_.line() + 1); }

  void read_item(const PlyElement& element, std::uint64_t item, std::vector<double>& values) {
    std::string_view line;
    if (!lines_.next_filled(line))
      refuse(source_, fmt::format("line {}: the file ends before {}: it is cut short, export it again", lines_.line(),
                                  place_of(element, item)));
    split(line, " \t", tokens_);
    std::size_t used = 0;
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (used == tokens_.size()) wrong_length(element, item, "too few");
      if (!property.is_list) {
        values[p] = parse_number(source_, lines_.line(), tokens_[used++]);
        continue;
      }
      const std::optional<std::uint64_t> length = parse_count(tokens_[used++]);
      if (!length || *length > tokens_.size() - used) wrong_length(element, item, "for its list length, too few");
      values[p] = static_cast<double>(*length);
      used += *length;
    }
    if (used < tokens_.size()) wrong_length(element, item, "too many");
  }

  void finish() { refuse_surplus(source_, lines_.offset()); }

 private:
  [[noreturn]] void wrong_length(const PlyElement& element, std::uint64_t item, std::string_view what) {
    refuse(source_, fmt::format("line {}: {} values for {} of {} properties: the file is cut short or damaged, export "
                                "it again",
                                lines_.line(), what, place_of(element, item), element.properties.size()));
  }

  const CloudSource& source_;
  LineReader lines_;
  std::vector<std::string_view> tokens_;
};

CloudColumns vertex_columns(const CloudSource& source, const PlyHeader& header) {
  std::vector<std::string> names;
  for (const PlyElement& element : header.elements)
    if (element.name == "vertex")
      for (const PlyProperty& p : element.properties) names.push_back(p.is_list ? "list " + p.name : p.name);
  return cloud_columns(source, names, "property");
}

/// Before memory is asked for.
template <class Body>
void check_count(const CloudSource& source, const Body& body, const PlyElement& element) {
  const std::size_t least = Body::bytes_per_item(element);
  if (least > 0 && element.count > body.bytes_left() / least)
    refuse(source, fmt::format("{}: the header announces {} x {}, at least {} bytes each, but {} bytes are left: the "
                               "file is cut short or the count is wrong, export it again",
                               body.place(), element.count, element.name, least, body.bytes_left()));
}

/// The first element that takes bytes begins where the header ends.
template <class Body>
void check_first_count(const CloudSource& head, const PlyHeader& header) {
  for (const PlyElement& element : header.elements)
    if (Body::bytes_per_item(element) > 0) return check_count(head, Body(head, header), element);
}

template <class Body>
OrientedPointCloud read_body(const CloudSource& source, const PlyHeader& header) {
  OrientedPointCloud cloud;
  Body body(source, header);
  const CloudColumns columns = vertex_columns(source, header);
  std::vector<double> values;
  for (const PlyElement& element : header.elements) {
    if (Body::bytes_per_item(element) == 0) continue;  // no properties, no bytes
    check_count(source, body, element);
    values.resize(element.properties.size());
    if (element.name != "vertex") {
      for (std::uint64_t item = 0; item < element.count; ++item) body.read_item(element, item, values);
      continue;
    }
    cloud.points.reserve(element.count);
    if (columns.has_normals) cloud.normals.reserve(element.count);
    if (columns.has_labels) cloud.labels.reserve(element.count);
    if (columns.has_origins) cloud.origins.reserve(element.count);
    for (std::uint64_t item = 0; item < element.count; ++item) {
      body.read_item(element, item, values);
      append_point(source, cloud, values, columns);
    }
  }
  body.finish();
  return cloud;
}

}  // namespace

void check_ply_head(const CloudSource& head) {
  const PlyHeader header = parse_ply_header(head);
  vertex_columns(head, header);
  if (header.format == PlyFormat::Ascii)
    check_first_count<AsciiBody>(head, header);
  else
    check_first_count<BinaryBody>(head, header);
}

CloudFile read_ply(const CloudSource& source) {
  const PlyHeader header = parse_ply_header(source);
  switch (header.format) {
    case PlyFormat::Ascii:
      return {read_body<AsciiBody>(source, header), {.format = "ply ascii"}};
    case PlyFormat::BinaryLittleEndian:
      return {read_body<BinaryBody>(source, header), {.format = "ply binary little endian"}};
    case PlyFormat::BinaryBigEndian:
      break;
  }
  return {read_body<BinaryBody>(source, header), {.format = "ply binary big endian"}};
}

}  // namespace umtet::detail
