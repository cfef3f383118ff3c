#include "common/vtk_xml/byte_stream.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <new>
#include <system_error>

namespace umtet::detail {
namespace {

constexpr std::size_t kPiece = 1 << 16;  // bytes that are read at once

gzFile of(void* gzip) { return static_cast<gzFile>(gzip); }

}  // namespace

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f'; }

ByteStream::ByteStream(const std::filesystem::path& file, Refusal refusal) : name_(file.string()), refusal_(refusal) {
  take_over(::open(name_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));  // a pipe does not keep us waiting
}

ByteStream::ByteStream(int descriptor, const std::filesystem::path& file, Refusal refusal)
    : name_(file.string()), refusal_(refusal) {
  ::lseek(descriptor, 0, SEEK_SET);  // a pipe is refused below
  take_over(::fcntl(descriptor, F_DUPFD_CLOEXEC, 0));
}

void ByteStream::take_over(int descriptor) {
  struct stat status = {};
  if (descriptor < 0 || ::fstat(descriptor, &status) != 0) {
    const int error = errno;
    if (descriptor >= 0) ::close(descriptor);
    throw std::system_error(error, std::generic_category(), name_ + ": cannot be opened");
  }
  if (!S_ISREG(status.st_mode)) {
    ::close(descriptor);
    refusal_(name_, "not a regular file; give the file itself");
  }
  file_size_ = static_cast<double>(status.st_size);
  gzip_ = ::gzdopen(descriptor, "rb");
  if (!gzip_) {
    ::close(descriptor);
    throw std::bad_alloc();
  }
}

ByteStream::~ByteStream() { ::gzclose(of(gzip_)); }

void ByteStream::refuse(const std::string& what) const {
  refusal_(name_, fmt::format("byte {}: {}", taken_, what));
  std::abort();  // a Refusal throws
}

double ByteStream::most_bytes() const {
  return ::gzdirect(of(gzip_)) ? file_size_ : static_cast<double>(kMostOfZlib) * file_size_;
}

std::size_t ByteStream::fill(char* to, std::size_t n) {
  const int got = ::gzread(of(gzip_), to, static_cast<unsigned>(n));
  int error = Z_OK;
  const char* what = ::gzerror(of(gzip_), &error);
  if (error == Z_ERRNO)
    throw std::system_error(errno ? errno : EIO, std::generic_category(), name_ + ": cannot be read");
  if (got < 0 || (error != Z_OK && error != Z_STREAM_END && error != Z_BUF_ERROR)) {
    refuse(fmt::format("damaged gzip data: {}", what));
  }
  return static_cast<std::size_t>(got);
}

/// Reads on. False at the end.
bool ByteStream::more() {
  buffer_.erase(0, next_);
  next_ = 0;
  const std::size_t before = buffer_.size();
  buffer_.resize(before + kPiece);
  buffer_.resize(before + fill(buffer_.data() + before, kPiece));
  return buffer_.size() > before;
}

std::string_view ByteStream::head(std::size_t n) {
  while (buffer_.size() < n && more()) continue;
  return std::string_view(buffer_).substr(0, n);
}

std::string ByteStream::take(std::uint64_t n) {
  std::string taken;
  while (taken.size() < n) {
    if (!has_more()) refuse(fmt::format("the file is cut: {} bytes are missing", n - taken.size()));
    const std::size_t now = std::min<std::uint64_t>(n - taken.size(), buffer_.size() - next_);
    taken.append(buffer_, next_, now);
    next_ += now;
    taken_ += now;
  }
  return taken;
}

std::string ByteStream::until(char stop, std::uint64_t most) {
  std::string taken;
  while (true) {
    if (!has_more()) refuse("the file is cut");
    const std::size_t end = std::min(buffer_.find(stop, next_), buffer_.size());
    taken.append(buffer_, next_, end - next_);
    taken_ += end - next_;
    next_ = end;
    if (taken.size() > most) {
      refuse(fmt::format("more than {} bytes before {}", most,
                         stop == '\n' ? "the line ends" : std::string{'\'', stop, '\''}));
    }
    if (next_ == buffer_.size()) continue;
    ++next_, ++taken_;
    return taken;
  }
}

std::string ByteStream::line() {
  std::string taken = until('\n', kLongestLine);
  if (!taken.empty() && taken.back() == '\r') taken.pop_back();
  return taken;
}

void ByteStream::skip(std::uint64_t n) {
  while (n > 0) {
    const std::uint64_t now = std::min<std::uint64_t>(n, kPiece);
    take(now);
    n -= now;
  }
}

void ByteStream::skip_to(char stop) {
  while (has_more()) {
    const std::size_t end = std::min(buffer_.find(stop, next_), buffer_.size());
    taken_ += end - next_;
    next_ = end;
    if (next_ < buffer_.size()) return;
  }
  refuse("the file is cut");
}

void ByteStream::skip_while(std::string_view characters) {
  while (has_more() && characters.find(buffer_[next_]) != std::string_view::npos) ++next_, ++taken_;
}

std::string ByteStream::last() {
  std::string last;
  while (has_more()) {
    last.append(buffer_, next_);
    taken_ += buffer_.size() - next_;
    next_ = buffer_.size();
    if (last.size() > kLast) last.erase(0, last.size() - kLast);
  }
  return last;
}

bool ByteStream::words(const std::function<bool(std::string_view)>& take) {
  std::string word;
  while (true) {
    const bool ended = !has_more() || buffer_[next_] == '<';
    const char c = ended ? ' ' : buffer_[next_];
    if (!ended) ++next_, ++taken_;
    if (!is_blank(c)) {
      word.push_back(c);
      if (word.size() > kLongestLine) refuse("a number of more than 64 kB");
      continue;
    }
    if (!word.empty() && !take(word)) return true;
    word.clear();
    if (ended) return false;
  }
}

void ByteStream::unpack_rest() {
  if (!::gzdirect(of(gzip_))) refuse("gzip within gzip");
  const int again = ::open(name_.c_str(), O_RDONLY | O_CLOEXEC);
  if (again < 0 || ::lseek(again, static_cast<off_t>(taken_), SEEK_SET) < 0) {
    const int error = errno;
    if (again >= 0) ::close(again);
    throw std::system_error(error, std::generic_category(), name_ + ": cannot be read");
  }
  gzFile packed = ::gzdopen(again, "rb");
  if (!packed) {
    ::close(again);
    throw std::bad_alloc();
  }
  ::gzclose(of(gzip_));
  gzip_ = packed;
  buffer_.clear();
  next_ = 0;
  if (!more() || ::gzdirect(packed)) refuse("the data are said to be of gzip, and are not");
}

}  // namespace umtet::detail
