#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>

#include "reconstruct/io/detail/cloud_source.h"

namespace umtet::detail {

/// Reads a file in two steps: a beginning, which tells most of what is no cloud before gigabytes are read, and the
/// rest.
class FileBytes {
 public:
  /// \throw std::system_error  the file cannot be opened; names it
  explicit FileBytes(const std::filesystem::path& file);
  /// What has been read so far.
  CloudSource source(bool needs_normals) const {
    return {.name = file_.string(), .bytes = bytes_, .needs_normals = needs_normals, .bytes_left_out = n_left_};
  }
  void read_rest();

 private:
  [[noreturn]] void fail(int error) const;
  bool read(std::size_t n);

  std::filesystem::path file_;
  std::ifstream in_;
  std::string bytes_;
  std::size_t n_left_ = 0;
};

/// Headers and rows of numbers have short lines. \throw CloudRefused  the first line does not end
void refuse_endless_line(const CloudSource& head);

/// In lower case, with its dot.
std::string lower_extension(const std::filesystem::path& file);

}  // namespace umtet::detail
