// The header has been checked: how many bytes are packed, and how many they become. liblzf writes no byte beyond those
// and reads none beyond the block; how the fields lie in it is ours.

#include "reconstruct/io/detail/clouds/pcd_unpack.h"

#include <fmt/format.h>
#include <lzf.h>

#include <cstring>

namespace umtet::detail {
namespace {

/// The block holds all values of the first field, then all of the next.
std::vector<std::uint8_t> by_points(const std::vector<std::uint8_t>& by_fields, const PcdHeader& header) {
  std::vector<std::uint8_t> points(by_fields.size());
  const std::uint8_t* from = by_fields.data();
  for (const PcdField& field : header.fields) {
    const std::size_t n_bytes = field.size * field.count;
    for (std::size_t i = 0; i < header.n_points; ++i, from += n_bytes)
      std::memcpy(points.data() + i * header.point_bytes + field.offset, from, n_bytes);
  }
  return points;
}

}  // namespace

std::vector<std::uint8_t> unpack(const CloudSource& source, const PcdHeader& header) {
  if (header.n_points == 0) return {};
  std::uint32_t n_packed = 0;
  std::memcpy(&n_packed, source.bytes.data() + header.body, sizeof n_packed);
  std::vector<std::uint8_t> fields(header.n_points * header.point_bytes);  // below 2^31
  const auto n_bytes = static_cast<unsigned>(fields.size());
  const char* block = source.bytes.data() + header.body + 2 * sizeof n_packed;
  if (lzf_decompress(block, n_packed, fields.data(), n_bytes) != n_bytes)
    refuse(source, fmt::format("byte {}: the compressed block cannot be unpacked: the file is damaged, export it again",
                               header.body));
  return by_points(fields, header);
}

}  // namespace umtet::detail
