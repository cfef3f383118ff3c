#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "reconstruct/io/detail/cloud_source.h"

namespace umtet::detail {

/// Reads a file in two steps: a beginning, which tells most of what is no cloud before gigabytes are read, and the
/// rest, at once or in blocks.
class FileBytes {
 public:
  /// \throw std::system_error  the file cannot be opened; names it
  explicit FileBytes(const std::filesystem::path& file);
  /// What has been read so far.
  CloudSource source(bool needs_normals) const {
    return {.name = file_.string(), .bytes = bytes_, .needs_normals = needs_normals, .bytes_left_out = n_left_};
  }
  void read_rest();
  /// What has been read so far, with what reads the rest in blocks. Do not move.
  CloudSource in_blocks(bool needs_normals) {
    CloudSource beginning = source(needs_normals);
    beginning.rest = this;
    return beginning;
  }
  /// The bytes from this one of the file on: n or more, or what is left. Those of the former call are gone.
  /// @param at  not before that of the former call. \throw std::system_error  they cannot be read
  std::string_view from(std::size_t at, std::size_t n);

 private:
  [[noreturn]] void fail(int error) const;
  /// Behind what `bytes` holds. @return false at the end of the file
  bool read(std::size_t n, std::string& bytes);

  std::filesystem::path file_;
  std::ifstream in_;
  std::string bytes_;
  std::size_t n_left_ = 0;
  std::string block_;
  std::size_t block_begin_ = 0;  ///< byte of the file
};

/// Headers and rows of numbers have short lines. \throw CloudRefused  the first line does not end
void refuse_endless_line(const CloudSource& head);

/// In lower case, with its dot.
std::string lower_extension(const std::filesystem::path& file);

}  // namespace umtet::detail
