#pragma once

#include <sys/stat.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace umtet {

/// A file that is open for reading, and its beginning. The tests of its format, the checks of its beginning, its
/// checksum and its content come from this object: so the file is opened once, and another file that takes its name
/// meanwhile has no effect.
class InputFile {
 public:
  /// Opens the file and reads its beginning. Opening a pipe waits for its writer.
  /// \throw std::system_error naming the file, if it cannot be opened or read, or is a folder
  explicit InputFile(const std::filesystem::path& file);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// The first megabyte, or the whole file if it is smaller.
  std::string_view head() const { return head_; }
  /// The state of the file when it was opened: its size, and the time of its last change.
  const struct stat& status() const { return status_; }
  int descriptor() const { return descriptor_; }

  /// Reads n bytes from position `at` on, or fewer at the end of the file. Bytes of a pipe can be read once, in order.
  /// @return the number of bytes that were read
  /// \throw std::system_error naming the file
  std::size_t read(std::size_t at, char* to, std::size_t n) const;

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  struct stat status_ = {};
  std::string head_;
};

}  // namespace umtet
