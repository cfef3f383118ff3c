// PCL unpacks the compressed bodies (LZF, then from fields to points) and sees neither the file nor its header:
// PCL 1.13 crashes on an empty file, aborts on counts it cannot allocate and reads zeros where a COUNT is negative. Its
// generic form PCLPointCloud2 keeps doubles, its point types do not. Other bodies do not pass through here: of a plain
// binary one PCL would make a copy and then look for NaN with 32-bit offsets, out of bounds beyond 2 GiB. The only file
// that includes PCL: its headers take seconds to compile.

#include "reconstruct/io/detail/pcd_unpack.h"

#include <fmt/format.h>

#ifdef UMTET_WITH_PCL
#include <pcl/PCLPointCloud2.h>
#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>

#include <utility>
#endif

namespace umtet::detail {

#ifdef UMTET_WITH_PCL
namespace {

/// PCL reports on stderr; what it finds wrong is told by its return value.
class QuietPcl {
 public:
  QuietPcl() : level_(pcl::console::getVerbosityLevel()) { pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS); }
  ~QuietPcl() { pcl::console::setVerbosityLevel(level_); }
  QuietPcl(const QuietPcl&) = delete;
  QuietPcl& operator=(const QuietPcl&) = delete;

 private:
  pcl::console::VERBOSITY_LEVEL level_;
};

std::uint8_t pcl_type(const PcdField& field) {
  using F = pcl::PCLPointField;
  switch (field.size) {
    case 1:
      return field.kind == 'I' ? F::INT8 : F::UINT8;
    case 2:
      return field.kind == 'I' ? F::INT16 : F::UINT16;
    case 4:
      return field.kind == 'F' ? F::FLOAT32 : field.kind == 'I' ? F::INT32 : F::UINT32;
    default:
      return field.kind == 'F' ? F::FLOAT64 : field.kind == 'I' ? F::INT64 : F::UINT64;
  }
}

}  // namespace

std::vector<std::uint8_t> unpack(const CloudSource& source, const PcdHeader& header) {
  if (header.n_points == 0) return {};  // PCL would take the address of its first byte
  const std::size_t n_bytes = header.n_points * header.point_bytes;
  pcl::PCLPointCloud2 blob;
  blob.width = static_cast<std::uint32_t>(header.n_points);
  blob.height = 1;
  blob.point_step = static_cast<std::uint32_t>(header.point_bytes);
  blob.row_step = static_cast<std::uint32_t>(n_bytes);
  blob.data.resize(n_bytes);
  for (const PcdField& f : header.fields) {
    pcl::PCLPointField& field = blob.fields.emplace_back();
    field.name = f.name;
    field.offset = static_cast<std::uint32_t>(f.offset);
    field.datatype = pcl_type(f);
    field.count = static_cast<std::uint32_t>(f.count);
  }
  const QuietPcl quiet;
  // The body is passed as if it began the file: PCL's offset has 32 bits only.
  const auto* body = reinterpret_cast<const unsigned char*>(source.bytes.data()) + header.body;
  constexpr bool kCompressed = true;
  if (pcl::PCDReader().readBodyBinary(body, blob, pcl::PCDReader::PCD_V7, kCompressed, 0) != 0 ||
      blob.data.size() != n_bytes)
    refuse(source, fmt::format("byte {}: the compressed block cannot be unpacked: the file is damaged, export it again",
                               header.body));
  return std::move(blob.data);
}
#else
std::vector<std::uint8_t> unpack(const CloudSource& source, const PcdHeader&) {
  refuse(source, "DATA binary_compressed takes PCL, and this umtet was built without it: install libpcl-dev and build again, or "
                 "save the cloud as binary or ascii");
}
#endif

}  // namespace umtet::detail
