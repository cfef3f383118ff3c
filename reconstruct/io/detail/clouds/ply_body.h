#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "reconstruct/io/detail/byte_window.h"
#include "reconstruct/io/detail/cloud_source.h"
#include "reconstruct/io/detail/clouds/ply_header.h"
#include "reconstruct/io/detail/text_rows.h"

namespace umtet::detail {

/// Receives the content of one list of an item.
struct PlyList {
  std::size_t property = 0;  ///< index of the property in its element
  std::size_t most = 0;      ///< maximum number of values; longer lists are rejected
  std::vector<double> values;
};

/// Reads items of a binary body one after the other. `values` receive one number per property (for a list its length;
/// its content is skipped unless it is the `wanted` one).
class BinaryBody {
 public:
  BinaryBody(const CloudSource& source, const PlyHeader& header);

  /// Minimum size of an item.
  static std::size_t bytes_per_item(const PlyElement& element);
  std::size_t bytes_left() const { return bytes_.bytes_left(); }
  std::string place() const;
  void read_item(const PlyElement& element, std::uint64_t item, std::vector<double>& values, PlyList* wanted = nullptr);
  void finish() { bytes_.refuse_surplus(); }

 private:
  const char* take(std::size_t n, const PlyElement& element, std::uint64_t item);

  const CloudSource& source_;
  ByteWindow bytes_;
  bool swap_;
};

/// Reads items of a text body, one item per line.
class AsciiBody {
 public:
  AsciiBody(const CloudSource& source, const PlyHeader& header)
      : source_(source), lines_(source.bytes, header.body, header.body_line) {}

  static std::size_t bytes_per_item(const PlyElement& element) { return 2 * element.properties.size(); }
  /// The last line may lack its end.
  std::size_t bytes_left() const { return source_.size() - lines_.offset() + 1; }
  std::string place() const;
  void read_item(const PlyElement& element, std::uint64_t item, std::vector<double>& values, PlyList* wanted = nullptr);
  void finish() { refuse_surplus(source_, lines_.offset()); }

 private:
  [[noreturn]] void wrong_length(const PlyElement& element, std::uint64_t item, std::string_view what);

  const CloudSource& source_;
  LineReader lines_;
  std::vector<std::string_view> tokens_;
};

/// "vertex 3 of 8".
std::string place_of(const PlyElement& element, std::uint64_t item);

/// Checks a count before memory is allocated. \throw CloudRefused if the header announces more than the file can hold
template <class Body>
void check_count(const CloudSource& source, const Body& body, const PlyElement& element);

}  // namespace umtet::detail
