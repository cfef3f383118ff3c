#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace umtet::detail {

/// Sequential reader of a regular file, which is decompressed if it is compressed by gzip. It trusts no count in the
/// file: memory grows with the bytes that are read. Functions that reject a file throw the exception of the Refusal
/// that the constructor receives.
class ByteStream {
 public:
  /// Throws the exception by which a reader rejects the content of a file.
  /// @param reason  begins with the position: "byte N: ..."
  using Refusal = void (*)(const std::string& file, const std::string& reason);

  /// \throw std::system_error if the file cannot be opened; the exception of `refusal` if it is not a regular file
  ByteStream(const std::filesystem::path& file, Refusal refusal);
  /// Reads a file that is open, from its beginning, and leaves it open.
  /// @param file  its path, for messages and unpack_rest()
  ByteStream(int descriptor, const std::filesystem::path& file, Refusal refusal);
  ~ByteStream();
  ByteStream(const ByteStream&) = delete;
  ByteStream& operator=(const ByteStream&) = delete;

  /// Returns the next n bytes without consuming them, or fewer at the end of the file. May only be called at the
  /// beginning of the file.
  std::string_view head(std::size_t n = kHead);
  /// Returns the next byte without consuming it; NUL at the end.
  char peek() { return has_more() ? buffer_[next_] : '\0'; }
  /// Reads n bytes. Rejects a file with fewer.
  std::string take(std::uint64_t n);
  /// Reads a line, without its end. Rejects the end of the file, and more than kLongestLine bytes.
  std::string line();
  /// Reads up to and including `stop`. Rejects the end of the file, and more than `most` bytes.
  std::string until(char stop, std::uint64_t most);
  /// Skips n bytes. Rejects a file with fewer.
  void skip(std::uint64_t n);
  /// Skips to `stop`. Rejects the end of the file.
  void skip_to(char stop);
  /// Skips all characters of this set.
  void skip_while(std::string_view characters);
  /// Skips the rest of the file. @return its last bytes, at most kLast
  std::string last();
  /// Passes words between blanks to `take`, which returns false after the last word that it needs. The words also end
  /// before '<' and at the end of the file. @return false if they ended while `take` needed more
  bool words(const std::function<bool(std::string_view)>& take);
  /// Decompresses the remaining bytes by gzip, even if the file begins with uncompressed bytes.
  void unpack_rest();

  [[noreturn]] void refuse(const std::string& what) const;
  const std::string& name() const { return name_; }
  std::uint64_t taken() const { return taken_; }
  /// Maximum number of bytes after decompression: the size of the file, times kMostOfZlib for gzip.
  double most_bytes() const;
  static constexpr std::size_t kHead = 4096, kLongestLine = 1 << 16, kLast = 64;

 private:
  /// Takes the descriptor, and closes it if it throws.
  void take_over(int descriptor);
  std::size_t fill(char* to, std::size_t n);
  bool more();
  bool has_more() { return next_ < buffer_.size() || more(); }

  std::string name_;
  Refusal refusal_;
  void* gzip_ = nullptr;  ///< gzFile
  double file_size_ = 0;
  std::string buffer_;  ///< bytes read from the file; those from next_ on are not yet consumed
  std::size_t next_ = 0;
  std::uint64_t taken_ = 0;
};

/// Maximum number of bytes to which one byte of zlib or gzip, and one byte of LZ4, can expand.
inline constexpr std::uint64_t kMostOfZlib = 1032, kMostOfLz4 = 255;

bool is_blank(char c);

}  // namespace umtet::detail
