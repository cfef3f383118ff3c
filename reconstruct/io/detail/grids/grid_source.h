#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/in_quotes.h"
#include "common/vtk_xml/byte_stream.h"
#include "common/vtk_xml/number_type.h"
#include "reconstruct/io/grid_io.h"

namespace umtet::detail {

/// Minimum size of a number as text, with its separator.
inline constexpr double kBytesOfWord = 2;

/// Storage type for a name used by C, VTK or NRRD ("unsigned char", "uint8_t", "UInt8", "vtktypeint64", "float" ...).
std::optional<NumberType> number_type(std::string_view name);

/// Thrown to stop reading if only the head of a file is requested.
struct EndOfHead {};

/// Sequential reader of a grid file, with a maximum number of nodes. It rejects a file by GridRefused.
class GridSource : public ByteStream {
 public:
  enum class Part { Whole, Head };
  /// @param max_nodes  maximum number of nodes of a grid
  /// @param part  Head: require_nodes() throws EndOfHead after its checks
  /// \throw GridRefused if it is not a regular file
  /// \throw std::system_error
  GridSource(const std::filesystem::path& file, double max_nodes, Part part = Part::Whole);
  GridSource(const InputFile& file, double max_nodes, Part part = Part::Whole);

  /// Checks that there are no more nodes than permitted, and no more than the file can contain with this number of
  /// bytes each.
  /// \throw GridRefused
  void require_nodes(const std::vector<std::int64_t>& counts, double bytes_each);
  /// Reads the numbers of n nodes. \throw GridRefused
  std::vector<double> take_numbers(std::uint64_t n, NumberType type, bool swap);
  /// Reads numbers written as text. \throw GridRefused
  std::vector<double> take_words(std::uint64_t n);

 private:
  double max_nodes_ = 0;
  Part part_;
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
