#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/vtk_xml/byte_stream.h"
#include "common/vtk_xml/number_type.h"
#include "common/vtk_xml/xml_tags.h"

namespace umtet::detail {

/// The attributes of a DataArray.
struct XmlArray {
  enum class Format { Ascii, Binary, Appended };
  std::string name;
  std::string type_name;
  std::optional<NumberType> type;  ///< none if the array contains no numbers
  std::uint64_t n_components = 1;
  Format format = Format::Ascii;
  std::uint64_t offset = 0;  ///< position in the appended data
};

/// Receives the numbers of an array in pieces of at most a megabyte. An array of integers goes to `integers`, without
/// rounding, if that is set. All other numbers go to `doubles`.
struct NumberSink {
  std::function<void(std::span<const double>)> doubles = {};
  std::function<void(std::span<const std::int64_t>)> integers = {};
};

/// Reads the arrays of a VTK XML file: ascii, inline base64, appended raw or base64; blocks of zlib or LZ4; headers of
/// 32 or 64 bits; both byte orders. Memory grows with the bytes that are read, never by a count in the file.
class ArrayReader {
 public:
  explicit ArrayReader(ByteStream& source) : source_(source) {}

  /// Takes byte order, header size and compressor from the root. Rejects a file of another type of grid.
  void take_root(const XmlTag& tag, std::string_view type);
  /// Parses the attributes of an array. Rejects an unknown format and an invalid number of components.
  XmlArray array(const XmlTag& tag) const;
  /// Minimum number of bytes in the file for a value.
  double least_bytes(const XmlArray& array) const;
  /// Maximum number of one-byte values that the whole file can contain.
  double most_values() const;
  bool is_little_endian() const { return !is_big_endian_; }
  bool has_wide_headers() const { return header_bytes_ == 8; }
  bool is_packed() const { return packer_ != Packer::None; }

  /// Passes the numbers of the array whose tag was read last to a sink: immediately, or in read_appended().
  /// @param n  the required number of values; none: any number
  void read(const XmlArray& array, std::optional<std::uint64_t> n, NumberSink sink);
  /// Reads all appended arrays. @param tag  the tag AppendedData, which must be the last tag that was read
  void read_appended(const XmlTag& tag);
  /// Checks the end of the file. The position is after the last tag, or in appended data, whose rest it skips. Rejects
  /// a truncated file, and a file without data for its appended arrays.
  void finish();

 private:
  enum class Packer { None, Zlib, Lz4 };
  class BlockBytes;
  struct Appended {
    XmlArray array;
    std::optional<std::uint64_t> n;
    NumberSink sink;
  };

  void read_words(const XmlArray& array, std::optional<std::uint64_t> n, const NumberSink& sink);
  void read_block(const XmlArray& array, bool is_base64, std::optional<std::uint64_t> n, const NumberSink& sink);
  void read_packed(const XmlArray& array, BlockBytes& bytes, std::optional<std::uint64_t> n_bytes,
                   const NumberSink& sink);
  void give(std::string_view bytes, NumberType type, const NumberSink& sink) const;
  void require_length(std::uint64_t n_bytes, std::optional<std::uint64_t> expected) const;
  std::uint64_t take_count(BlockBytes& bytes) const;
  std::string unpacked(const std::string& packed, std::uint64_t size) const;
  std::uint64_t ratio() const;

  ByteStream& source_;
  std::vector<Appended> appended_;
  std::uint64_t header_bytes_ = 4;
  bool is_big_endian_ = false, has_read_appended_ = false;
  Packer packer_ = Packer::None;
};

}  // namespace umtet::detail
