#include "mesh/io/checked_file.h"

#include <cerrno>
#include <system_error>
#include <utility>

namespace umtet {
namespace {
constexpr std::size_t kBufferBytes = std::size_t{1} << 18;
}

CheckedFile::CheckedFile(std::filesystem::path path) : path_(std::move(path)) {
  file_ = std::fopen(path_.c_str(), "wb");
  if (!file_) fail(errno);
  std::setvbuf(file_, nullptr, _IONBF, 0);  // the buffer is ours, so that an error shows at the write that meets it
  buffer_.reserve(kBufferBytes);
}

CheckedFile::~CheckedFile() {
  if (file_) std::fclose(file_);
}

CheckedFile& CheckedFile::bytes(const char* data, std::size_t size) {
  if (buffer_.size() + size > kBufferBytes) flush();
  if (size > kBufferBytes) {
    if (std::fwrite(data, 1, size, file_) != size) fail(errno);
    return *this;
  }
  buffer_.insert(buffer_.end(), data, data + size);
  return *this;
}

void CheckedFile::flush() {
  if (!buffer_.empty() && std::fwrite(buffer_.data(), 1, buffer_.size(), file_) != buffer_.size()) fail(errno);
  buffer_.clear();
}

void CheckedFile::close() {
  flush();
  std::FILE* const file = std::exchange(file_, nullptr);
  if (std::fclose(file) != 0) fail(errno);
}

void CheckedFile::fail(int error) const {
  throw std::system_error(error, std::generic_category(), "cannot write " + path_.string());
}

}  // namespace umtet
