#pragma once

#include <cstddef>
#include <string_view>

#include "reconstruct/io/detail/cloud_source.h"

namespace umtet::detail {

/// Sequential reader of the bytes of a file, which are all in memory, or read in blocks by the source.
class ByteWindow {
 public:
  /// @param at  first byte to read; the source has to hold it
  ByteWindow(const CloudSource& source, std::size_t at) : source_(source), window_(source.bytes), at_(at) {}

  std::size_t at() const { return at_; }  ///< position in the file
  std::size_t bytes_left() const { return source_.size() - at_; }
  /// The next n bytes, valid until the next call; null if the file ends before.
  const char* take(std::size_t n);
  /// \throw CloudRefused if anything but blanks and NUL padding follows
  void refuse_surplus();

 private:
  std::size_t in_window() const { return begin_ + window_.size() - at_; }

  const CloudSource& source_;
  std::string_view window_;
  std::size_t begin_ = 0;  ///< position in the file where the window begins
  std::size_t at_;
};

}  // namespace umtet::detail
