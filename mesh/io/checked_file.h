#pragma once

#include <charconv>
#include <concepts>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace umtet {

/// Output file that detects every failed write: all writes and the close are checked.
/// \throw std::system_error naming the path, from every member but the destructor
class CheckedFile {
 public:
  explicit CheckedFile(std::filesystem::path path);
  ~CheckedFile();
  CheckedFile(const CheckedFile&) = delete;
  CheckedFile& operator=(const CheckedFile&) = delete;

  CheckedFile& text(std::string_view s) { return bytes(s.data(), s.size()); }
  /// Writes the shortest text that reads back to the same value, in any locale.
  template <typename T>
  requires std::integral<T> || std::floating_point<T> CheckedFile& number(T value) {
    char digits[32];
    const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
    return bytes(digits, static_cast<std::size_t>(end - digits));
  }
  /// Writes the value's bytes as in memory.
  template <typename T>
  requires std::integral<T> || std::floating_point<T> CheckedFile& raw(T value) {
    return bytes(reinterpret_cast<const char*>(&value), sizeof value);
  }
  /// Flushes and closes. A file that was not closed counts as not written.
  void close();

 private:
  CheckedFile& bytes(const char* data, std::size_t size);
  void flush();
  [[noreturn]] void fail(int error) const;

  std::filesystem::path path_;
  std::FILE* file_;
  std::vector<char> buffer_;
};

}  // namespace umtet
