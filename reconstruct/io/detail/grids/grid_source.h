#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "reconstruct/io/detail/cloud_source.h"  // in_quotes()
#include "reconstruct/io/grid_io.h"

namespace umtet::detail {

/// Storage type of a number.
struct NumberType {
  enum class Kind { Signed, Unsigned, Float };
  Kind kind;
  int bytes;  ///< 1, 2, 4 or 8
};

/// Minimum size of a number as text, with its separator.
inline constexpr double kBytesOfWord = 2;

/// Storage type for a name used by C, VTK or NRRD ("unsigned char", "uint8_t", "UInt8", "vtktypeint64", "float" ...).
std::optional<NumberType> number_type(std::string_view name);

/// Appends the numbers stored in some bytes. @param swap  reverses the bytes of each number
void append_numbers(std::string_view bytes, NumberType type, bool swap, std::vector<double>& out);

/// Thrown to stop reading if only the head of a file is requested.
struct EndOfHead {};

/// Sequential reader of a file, which is decompressed if it is compressed by gzip.
class GridSource {
 public:
  enum class Part { Whole, Head };
  /// @param max_nodes  maximum number of nodes of a grid
  /// @param part  Head: require_nodes() throws EndOfHead after its checks
  /// \throw GridRefused if it is not a regular file
  /// \throw std::system_error
  GridSource(const std::filesystem::path& file, double max_nodes, Part part = Part::Whole);
  ~GridSource();
  GridSource(const GridSource&) = delete;
  GridSource& operator=(const GridSource&) = delete;

  /// The next bytes without consuming them, at most kHead, and fewer at the end. At the front of the file only.
  std::string_view head();
  /// Reads n bytes; memory grows with the data. \throw GridRefused if there are fewer
  std::string take(std::uint64_t n);
  /// Reads a line, without its end. \throw GridRefused at the end of the file, or for a line longer than kLongestLine
  std::string line();
  /// Reads up to and including `stop`. \throw GridRefused at the end of the file, or after `most` bytes
  std::string until(char stop, std::uint64_t most);
  /// Skips n bytes. \throw GridRefused if there are fewer
  void skip(std::uint64_t n);
  /// Skips to `stop`. \throw GridRefused at the end of the file
  void skip_to(char stop);
  /// Skips all characters of this set.
  void skip_while(std::string_view characters);
  /// Decompresses the remaining bytes by gzip, whatever came before.
  void unpack_rest();

  /// Checks that there are no more nodes than permitted, and no more than the file can contain with this number of
  /// bytes each.
  /// \throw GridRefused
  void require_nodes(const std::vector<std::int64_t>& counts, double bytes_each);
  /// Reads the numbers of n nodes. \throw GridRefused
  std::vector<double> take_numbers(std::uint64_t n, NumberType type, bool swap);
  /// Reads numbers written as text. \throw GridRefused
  std::vector<double> take_words(std::uint64_t n);

  /// Rejects the file. \throw GridRefused  "FILE: byte N: what"
  [[noreturn]] void refuse(const std::string& what) const;
  const std::string& name() const { return name_; }
  static constexpr std::size_t kHead = 4096, kLongestLine = 1 << 16;

 private:
  std::size_t fill(char* to, std::size_t n);
  bool more();
  double most_bytes() const;

  std::string name_;
  void* gzip_ = nullptr;  ///< gzFile
  double file_size_ = 0, max_nodes_ = 0;
  Part part_;
  std::string buffer_;  ///< read, but not consumed, from next_ on
  std::size_t next_ = 0;
  std::uint64_t taken_ = 0;
};

/// Parse a word. \throw GridRefused if it is not a number, or if anything follows it
double number_of(const GridSource& source, std::string_view word);
std::int64_t count_of(const GridSource& source, std::string_view word);
/// The words of a text, separated by blanks.
std::vector<std::string_view> words_of(std::string_view text);

/// One reader per format; they check the structure of the file. \throw GridRefused
Grid read_nrrd(GridSource& source);
Grid read_nifti(GridSource& source);
Grid read_structured_points(GridSource& source);
Grid read_image_data(GridSource& source);

}  // namespace umtet::detail
