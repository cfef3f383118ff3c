#include "reconstruct/io/input_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace umtet {
namespace {

constexpr std::size_t kHead = 1 << 20;  // real headers have some hundred bytes, with comments some thousand

[[noreturn]] void fail(int error, const std::filesystem::path& file) {
  throw std::system_error(error, std::generic_category(), file.string());
}

}  // namespace

InputFile::InputFile(const std::filesystem::path& file) : path_(file) {
  descriptor_ = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor_ < 0) fail(errno, file);
  try {
    if (::fstat(descriptor_, &status_) != 0) fail(errno, file);
    head_.resize(kHead);
    head_.resize(read(0, head_.data(), kHead));
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

InputFile::~InputFile() { ::close(descriptor_); }

std::size_t InputFile::read(std::size_t at, char* to, std::size_t n) const {
  std::size_t n_read = 0;
  while (n_read < n) {
    ssize_t got = ::pread(descriptor_, to + n_read, n - n_read, static_cast<off_t>(at + n_read));
    if (got < 0 && errno == ESPIPE) got = ::read(descriptor_, to + n_read, n - n_read);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail(errno, path_);
    if (got == 0) break;
    n_read += static_cast<std::size_t>(got);
  }
  return n_read;
}

}  // namespace umtet
