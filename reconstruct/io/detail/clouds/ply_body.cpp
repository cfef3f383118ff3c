#include "reconstruct/io/detail/clouds/ply_body.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>

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

void refuse_long_list(const CloudSource& source, const PlyList& list, std::size_t n, const std::string& item) {
  if (n > list.most)
    refuse(source,
           fmt::format("{}: a list of {} values, more than the {} that are read: split it", item, n, list.most));
}

}  // namespace

std::string place_of(const PlyElement& element, std::uint64_t item) {
  return fmt::format("{} {} of {}", element.name, item + 1, element.count);
}

BinaryBody::BinaryBody(const CloudSource& source, const PlyHeader& header)
    : source_(source),
      bytes_(source, header.body),
      swap_((header.format == PlyFormat::BinaryBigEndian) != (std::endian::native == std::endian::big)) {}

std::size_t BinaryBody::bytes_per_item(const PlyElement& element) {
  std::size_t bytes = 0;
  for (const PlyProperty& p : element.properties) bytes += byte_size(p.is_list ? p.count_type : p.type);
  return bytes;
}

std::string BinaryBody::place() const { return fmt::format("byte {}", bytes_.at()); }

void BinaryBody::read_item(const PlyElement& element, std::uint64_t item, std::vector<double>& values,
                           PlyList* wanted) {
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
    const auto n = static_cast<std::size_t>(values[p]);
    const std::size_t size = byte_size(property.type);
    const char* const bytes = take(n * size, element, item);
    if (!wanted || wanted->property != p) continue;
    refuse_long_list(source_, *wanted, n, place_of(element, item));
    wanted->values.resize(n);
    for (std::size_t i = 0; i < n; ++i) wanted->values[i] = decode(property.type, bytes + i * size, swap_);
  }
}

const char* BinaryBody::take(std::size_t n, const PlyElement& element, std::uint64_t item) {
  if (const char* const bytes = bytes_.take(n)) return bytes;
  refuse(source_, fmt::format("{}: the file ends inside {}: it is cut short or a list length is wrong, export it again",
                              place(), place_of(element, item)));
}

std::string AsciiBody::place() const { return fmt::format("line {}", lines_.line() + 1); }

void AsciiBody::read_item(const PlyElement& element, std::uint64_t item, std::vector<double>& values, PlyList* wanted) {
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
    if (wanted && wanted->property == p) {
      refuse_long_list(source_, *wanted, *length, place_of(element, item));
      wanted->values.resize(*length);
      for (std::size_t i = 0; i < *length; ++i)
        wanted->values[i] = parse_number(source_, lines_.line(), tokens_[used + i]);
    }
    used += *length;
  }
  if (used < tokens_.size()) wrong_length(element, item, "too many");
}

void AsciiBody::wrong_length(const PlyElement& element, std::uint64_t item, std::string_view what) {
  refuse(source_, fmt::format("line {}: {} values for {} of {} properties: the file is cut short or damaged, export "
                              "it again",
                              lines_.line(), what, place_of(element, item), element.properties.size()));
}

template <class Body>
void check_count(const CloudSource& source, const Body& body, const PlyElement& element) {
  const std::size_t least = Body::bytes_per_item(element);
  if (least > 0 && element.count > body.bytes_left() / least)
    refuse(source, fmt::format("{}: the header announces {} x {}, at least {} bytes each, but {} bytes are left: the "
                               "file is cut short or the count is wrong, export it again",
                               body.place(), element.count, element.name, least, body.bytes_left()));
}

template void check_count(const CloudSource&, const BinaryBody&, const PlyElement&);
template void check_count(const CloudSource&, const AsciiBody&, const PlyElement&);

}  // namespace umtet::detail
