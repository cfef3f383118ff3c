#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "reconstruct/io/detail/cloud_source.h"
#include "reconstruct/io/input_file.h"

namespace umtet::detail {

/// Reads a file in two steps: the beginning, which identifies most invalid files before gigabytes are read, and the
/// rest, at once or in blocks.
class FileBytes {
 public:
  /// @param file  has to outlive the object
  explicit FileBytes(const InputFile& file);
  /// The bytes read so far.
  CloudSource source(bool needs_normals) const {
    return {.name = file_.path().string(), .bytes = bytes_, .needs_normals = needs_normals, .bytes_left_out = n_left_};
  }
  void read_rest();
  /// The bytes read so far, with access to the rest in blocks. The object must not be moved afterwards.
  CloudSource in_blocks(bool needs_normals) {
    CloudSource beginning = source(needs_normals);
    beginning.rest = this;
    return beginning;
  }
  /// The bytes from a position on: n or more, or all that remain. They replace those of the previous call.
  /// @param at  not before the position of the previous call
  /// \throw std::system_error if they cannot be read
  std::string_view from(std::size_t at, std::size_t n);

 private:
  /// Reads further bytes and appends them to `bytes`. @return false at the end of the file
  bool read(std::size_t n, std::string& bytes);

  const InputFile& file_;
  std::string bytes_;
  std::size_t at_;  ///< position in the file after the bytes read so far
  std::size_t n_left_ = 0;
  std::string block_;
  std::size_t block_begin_ = 0;  ///< position in the file
};

/// Checks that the first line ends: headers and rows of numbers have short lines. \throw CloudRefused if it does not
void refuse_endless_line(const CloudSource& head);

/// The extension in lower case, with its dot.
std::string lower_extension(const std::filesystem::path& file);

}  // namespace umtet::detail
