#include "reconstruct/io/detail/file_bytes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <string_view>
#include <system_error>

namespace umtet::detail {
namespace {

constexpr std::size_t kHead = 1 << 20;  // real headers have some hundred bytes, with comments some thousand

}  // namespace

FileBytes::FileBytes(const std::filesystem::path& file) : file_(file) {
  if (std::filesystem::is_directory(file)) fail(EISDIR);
  errno = 0;
  in_.open(file, std::ios::binary);
  if (!in_) fail(errno);
  read(kHead, bytes_);
  std::error_code unknown;  // of a pipe
  const std::uintmax_t size = std::filesystem::file_size(file, unknown);
  if (!unknown && size > bytes_.size()) n_left_ = size - bytes_.size();
}

void FileBytes::read_rest() {
  if (in_.eof()) return;
  bytes_.reserve(bytes_.size() + n_left_ + kHead);  // it grows by a whole step before it is cut
  while (read(kHead, bytes_)) {
  }
  n_left_ = 0;
}

void FileBytes::fail(int error) const {
  throw std::system_error(error != 0 ? error : EIO, std::generic_category(), file_.string());
}

std::string_view FileBytes::from(std::size_t at, std::size_t n) {
  if (block_begin_ == 0) {
    block_ = bytes_;
    block_.erase(0, at);
  } else {
    block_.erase(0, at - block_begin_);
  }
  block_begin_ = at;
  while (block_.size() < n && read(std::max(kHead, n - block_.size()), block_)) {
  }
  return block_;
}

bool FileBytes::read(std::size_t n, std::string& bytes) {
  if (in_.eof()) return false;
  const std::size_t before = bytes.size();
  bytes.resize(before + n);
  in_.read(bytes.data() + before, static_cast<std::streamsize>(n));
  bytes.resize(before + static_cast<std::size_t>(in_.gcount()));
  if (in_.bad()) fail(errno);
  return in_.gcount() > 0;
}

void refuse_endless_line(const CloudSource& head) {
  const std::string_view begin = head.bytes.substr(0, 1 << 16);
  if (begin.size() < 1 << 16) return;
  if (begin.find('\n') != std::string_view::npos || begin.find('\r') != std::string_view::npos) return;
  refuse(head, fmt::format("line 1 does not end in the first {} bytes: this is no PLY, PCD or text with a point a line",
                           begin.size()));
}

std::string lower_extension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

}  // namespace umtet::detail
