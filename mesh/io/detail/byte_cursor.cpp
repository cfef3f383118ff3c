#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <system_error>

#include "mesh/io/detail/mesh_formats.h"

namespace umtet::detail {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f'; }

/// Foreign text in a message: short and printable.
std::string shown(std::string_view text) {
  std::string s(text.substr(0, 24));
  for (char& c : s)
    if (c < ' ' || c > '~') c = '?';
  return "'" + s + (text.size() > 24 ? "...'" : "'");
}

}  // namespace

void ByteCursor::refuse(const std::string& reason) const {
  const auto line = 1 + std::count(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(at_), '\n');
  throw MeshFileRefused(path_, "byte " + std::to_string(at_) + ", line " + std::to_string(line), reason);
}

std::string_view ByteCursor::line() {
  const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
  std::string_view text = bytes_.substr(at_, end - at_);
  at_ = std::min(end + 1, bytes_.size());
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string_view ByteCursor::word() {
  for (;;) {
    while (at_ < bytes_.size() && is_blank(bytes_[at_])) ++at_;
    if (comment_ == '\0' || at_ == bytes_.size() || bytes_[at_] != comment_) break;
    line();
  }
  const std::size_t begin = at_;
  while (at_ < bytes_.size() && !is_blank(bytes_[at_])) ++at_;
  return bytes_.substr(begin, at_ - begin);
}

template <typename T>
T ByteCursor::number(const char* what) {
  std::string_view text = word();
  if (text.empty()) refuse(std::string(what) + ": the file ends here");
  if (text.front() == '+') text.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    refuse(std::string(what) + ": not a number: " + shown(text));
  return value;
}
template double ByteCursor::number<double>(const char*);
template std::int64_t ByteCursor::number<std::int64_t>(const char*);
template std::uint64_t ByteCursor::number<std::uint64_t>(const char*);

template <typename T>
T ByteCursor::raw(const char* what) {
  if (remaining() < sizeof(T)) refuse(std::string(what) + ": the file ends here");
  T value;
  std::memcpy(&value, bytes_.data() + at_, sizeof value);
  at_ += sizeof value;
  return value;
}
template double ByteCursor::raw<double>(const char*);
template std::int32_t ByteCursor::raw<std::int32_t>(const char*);
template std::uint64_t ByteCursor::raw<std::uint64_t>(const char*);

void ByteCursor::skip(std::size_t n_bytes, const char* what) {
  if (remaining() < n_bytes) refuse(std::string(what) + ": the file ends here");
  at_ += n_bytes;
}

void ByteCursor::skip_behind_line(std::string_view text) {
  for (std::size_t from = at_;;) {
    const std::size_t found = bytes_.find(text, from);
    if (found == std::string_view::npos) refuse("no " + std::string(text) + " behind this place");
    const std::size_t end = found + text.size();
    if (end == bytes_.size() || is_blank(bytes_[end])) {
      at_ = end;
      line();
      return;
    }
    from = found + 1;
  }
}

std::size_t ByteCursor::checked_count(std::uint64_t n, const char* what, std::size_t least_bytes) const {
  if (n > remaining() / least_bytes) {
    refuse(std::string(what) + " = " + std::to_string(n) + ": more than the file can hold");
  }
  return static_cast<std::size_t>(n);
}

std::size_t ByteCursor::count(const char* what, std::size_t least_bytes) {
  return checked_count(number<std::uint64_t>(what), what, least_bytes);
}

void require_regular_file(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_regular_file(path, error)) return;
  if (!error) error = std::make_error_code(std::errc::invalid_argument);
  throw std::system_error(error, "cannot read " + path.string() + " as a file");
}

std::string file_bytes(const std::filesystem::path& path, std::string_view keyword) {
  constexpr std::size_t kHead = 1 << 20;
  require_regular_file(path);
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  const std::size_t size = in ? std::filesystem::file_size(path) : 0;
  std::string bytes(std::min(size, kHead), '\0');
  const auto read = [&](std::size_t from) {
    if (!in || !in.read(bytes.data() + from, static_cast<std::streamsize>(bytes.size() - from)))
      throw std::system_error(errno ? errno : EIO, std::generic_category(), "cannot read " + path.string());
  };
  read(0);
  const auto same = [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); };
  if (bytes.size() < size &&
      std::search(bytes.begin(), bytes.end(), keyword.begin(), keyword.end(), same) == bytes.end())
    throw MeshFileRefused(path, "byte 0", "no " + std::string(keyword) + " in the first megabyte");
  bytes.resize(size);
  read(std::min(size, kHead));
  return bytes;
}

}  // namespace umtet::detail
