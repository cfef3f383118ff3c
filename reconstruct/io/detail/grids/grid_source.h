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

/// How a number is stored.
struct NumberType {
  enum class Kind { Signed, Unsigned, Float };
  Kind kind;
  int bytes;  ///< 1, 2, 4 or 8
};

/// Of numbers as text, with what is between them: not less.
inline constexpr double kBytesOfWord = 2;

/// Of a name that C, VTK or NRRD have for it ("unsigned char", "uint8_t", "UInt8", "vtktypeint64", "float" ...).
std::optional<NumberType> number_type(std::string_view name);

/// The numbers of some bytes, appended. @param swap  the bytes of each are the wrong way round
void append_numbers(std::string_view bytes, NumberType type, bool swap, std::vector<double>& out);

/// Thrown in place of reading on where only the head of a file is wanted.
struct EndOfHead {};

/// The bytes of a file, unpacked if it is one of gzip, from the front to the back.
class GridSource {
 public:
  enum class Part { Whole, Head };
  /// @param max_nodes  a grid may have
  /// @param part  Head: require_nodes() throws EndOfHead after its checks
  /// \throw GridRefused  not a regular file \throw std::system_error
  GridSource(const std::filesystem::path& file, double max_nodes, Part part = Part::Whole);
  ~GridSource();
  GridSource(const GridSource&) = delete;
  GridSource& operator=(const GridSource&) = delete;

  /// The next bytes without taking them, fewer at the end; at most kHead. Only at the front.
  std::string_view head();
  /// Takes n bytes; memory grows as they come. \throw GridRefused  there are not so many
  std::string take(std::uint64_t n);
  /// Takes a line, without its end. \throw GridRefused  at the end of the file, or longer than kLongestLine
  std::string line();
  /// Takes what comes before `stop`, and `stop`. \throw GridRefused  at the end of the file, or after `most` bytes
  std::string until(char stop, std::uint64_t most);
  /// Leaves n bytes out. \throw GridRefused  there are not so many
  void skip(std::uint64_t n);
  /// Leaves out what comes before `stop`. \throw GridRefused  at the end of the file
  void skip_to(char stop);
  /// Leaves out what consists of these.
  void skip_while(std::string_view characters);
  /// What is left is of gzip, whatever came before.
  void unpack_rest();

  /// No more nodes than are allowed, and, with so many bytes each, than the file can have.
  /// \throw GridRefused
  void require_nodes(const std::vector<std::int64_t>& counts, double bytes_each);
  /// Takes the numbers of n nodes. \throw GridRefused
  std::vector<double> take_numbers(std::uint64_t n, NumberType type, bool swap);
  /// The same written as text. \throw GridRefused
  std::vector<double> take_words(std::uint64_t n);

  /// \throw GridRefused  "FILE: byte N: what"
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
  std::string buffer_;  ///< read, but not taken yet, from next_ on
  std::size_t next_ = 0;
  std::uint64_t taken_ = 0;
};

/// \throw GridRefused  not a number, or something behind it
double number_of(const GridSource& source, std::string_view word);
std::int64_t count_of(const GridSource& source, std::string_view word);
/// Between blanks.
std::vector<std::string_view> words_of(std::string_view text);

/// One reader for each format; they check the shape of the file. \throw GridRefused
Grid read_nrrd(GridSource& source);
Grid read_nifti(GridSource& source);
Grid read_structured_points(GridSource& source);
Grid read_image_data(GridSource& source);

}  // namespace umtet::detail
