#include "reconstruct/io/detail/file_bytes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string_view>

namespace umtet::detail {
namespace {

constexpr std::size_t kPiece = 1 << 20;  // bytes that are read at once: many more than a call costs

}  // namespace

FileBytes::FileBytes(const InputFile& file) : file_(file), bytes_(file.head()), at_(bytes_.size()) {
  const auto size = static_cast<std::size_t>(file.status().st_size);  // 0 of a pipe
  if (size > at_) n_left_ = size - at_;
}

void FileBytes::read_rest() {
  bytes_.reserve(bytes_.size() + n_left_ + kPiece);  // it grows by a whole step before it is cut
  while (read(kPiece, bytes_)) {
  }
  n_left_ = 0;
}

std::string_view FileBytes::from(std::size_t at, std::size_t n) {
  if (block_begin_ == 0) {
    block_ = bytes_;
    block_.erase(0, at);
  } else {
    block_.erase(0, at - block_begin_);
  }
  block_begin_ = at;
  while (block_.size() < n && read(std::max(kPiece, n - block_.size()), block_)) {
  }
  return block_;
}

bool FileBytes::read(std::size_t n, std::string& bytes) {
  const std::size_t before = bytes.size();
  bytes.resize(before + n);
  const std::size_t n_read = file_.read(at_, bytes.data() + before, n);
  bytes.resize(before + n_read);
  at_ += n_read;
  return n_read > 0;
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
