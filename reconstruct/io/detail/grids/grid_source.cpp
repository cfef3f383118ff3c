#include "reconstruct/io/detail/grids/grid_source.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <system_error>
namespace umtet::detail {
namespace {

constexpr std::size_t kPiece = 1 << 16;  // bytes that are read at once
constexpr double kMostOfGzip = 1032;     // bytes that one byte of gzip can stand for

template <class T>
void append_as(std::string_view bytes, bool swap, std::vector<double>& out) {
  for (std::size_t at = 0; at + sizeof(T) <= bytes.size(); at += sizeof(T)) {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes.data() + at, sizeof(T));
    if (swap) std::reverse(raw.begin(), raw.end());
    out.push_back(static_cast<double>(std::bit_cast<T>(raw)));
  }
}

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f'; }

}  // namespace

std::optional<NumberType> number_type(std::string_view name) {
  using Kind = NumberType::Kind;
  static const std::map<std::string, NumberType, std::less<>> kTypes = {{"char", {Kind::Signed, 1}},
                                                                        {"signed char", {Kind::Signed, 1}},
                                                                        {"int8", {Kind::Signed, 1}},
                                                                        {"int8_t", {Kind::Signed, 1}},
                                                                        {"unsigned char", {Kind::Unsigned, 1}},
                                                                        {"unsigned_char", {Kind::Unsigned, 1}},
                                                                        {"uchar", {Kind::Unsigned, 1}},
                                                                        {"uint8", {Kind::Unsigned, 1}},
                                                                        {"uint8_t", {Kind::Unsigned, 1}},
                                                                        {"short", {Kind::Signed, 2}},
                                                                        {"short int", {Kind::Signed, 2}},
                                                                        {"signed short", {Kind::Signed, 2}},
                                                                        {"signed short int", {Kind::Signed, 2}},
                                                                        {"int16", {Kind::Signed, 2}},
                                                                        {"int16_t", {Kind::Signed, 2}},
                                                                        {"ushort", {Kind::Unsigned, 2}},
                                                                        {"unsigned short", {Kind::Unsigned, 2}},
                                                                        {"unsigned_short", {Kind::Unsigned, 2}},
                                                                        {"unsigned short int", {Kind::Unsigned, 2}},
                                                                        {"uint16", {Kind::Unsigned, 2}},
                                                                        {"uint16_t", {Kind::Unsigned, 2}},
                                                                        {"int", {Kind::Signed, 4}},
                                                                        {"signed int", {Kind::Signed, 4}},
                                                                        {"int32", {Kind::Signed, 4}},
                                                                        {"int32_t", {Kind::Signed, 4}},
                                                                        {"uint", {Kind::Unsigned, 4}},
                                                                        {"unsigned int", {Kind::Unsigned, 4}},
                                                                        {"unsigned_int", {Kind::Unsigned, 4}},
                                                                        {"uint32", {Kind::Unsigned, 4}},
                                                                        {"uint32_t", {Kind::Unsigned, 4}},
                                                                        {"longlong", {Kind::Signed, 8}},
                                                                        {"long long", {Kind::Signed, 8}},
                                                                        {"long", {Kind::Signed, 8}},
                                                                        {"vtktypeint64", {Kind::Signed, 8}},
                                                                        {"vtkidtype", {Kind::Signed, 8}},
                                                                        {"int64", {Kind::Signed, 8}},
                                                                        {"int64_t", {Kind::Signed, 8}},
                                                                        {"ulonglong", {Kind::Unsigned, 8}},
                                                                        {"unsigned long long", {Kind::Unsigned, 8}},
                                                                        {"unsigned_long", {Kind::Unsigned, 8}},
                                                                        {"vtktypeuint64", {Kind::Unsigned, 8}},
                                                                        {"uint64", {Kind::Unsigned, 8}},
                                                                        {"uint64_t", {Kind::Unsigned, 8}},
                                                                        {"float", {Kind::Float, 4}},
                                                                        {"float32", {Kind::Float, 4}},
                                                                        {"double", {Kind::Float, 8}},
                                                                        {"float64", {Kind::Float, 8}}};
  std::string lower(name.substr(0, 40));
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  const auto found = kTypes.find(lower);
  return found == kTypes.end() ? std::nullopt : std::optional(found->second);
}

void append_numbers(std::string_view bytes, NumberType type, bool swap, std::vector<double>& out) {
  using Kind = NumberType::Kind;
  if (type.kind == Kind::Float) {
    type.bytes == 4 ? append_as<float>(bytes, swap, out) : append_as<double>(bytes, swap, out);
    return;
  }
  const bool has_sign = type.kind == Kind::Signed;
  switch (type.bytes) {
    case 1:
      return has_sign ? append_as<std::int8_t>(bytes, swap, out) : append_as<std::uint8_t>(bytes, swap, out);
    case 2:
      return has_sign ? append_as<std::int16_t>(bytes, swap, out) : append_as<std::uint16_t>(bytes, swap, out);
    case 4:
      return has_sign ? append_as<std::int32_t>(bytes, swap, out) : append_as<std::uint32_t>(bytes, swap, out);
    default:
      return has_sign ? append_as<std::int64_t>(bytes, swap, out) : append_as<std::uint64_t>(bytes, swap, out);
  }
}

GridSource::GridSource(const std::filesystem::path& file, double max_nodes, Part part)
    : name_(file.string()), max_nodes_(max_nodes), part_(part) {
  const int descriptor = ::open(name_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // a pipe does not keep us waiting
  struct stat status = {};
  if (descriptor < 0 || ::fstat(descriptor, &status) != 0) {
    const int error = errno;
    if (descriptor >= 0) ::close(descriptor);
    throw std::system_error(error, std::generic_category(), name_ + ": cannot be opened");
  }
  if (!S_ISREG(status.st_mode)) {
    ::close(descriptor);
    throw GridRefused(name_ + ": not a regular file; give the file of the grid");
  }
  file_size_ = static_cast<double>(status.st_size);
  gzip_ = ::gzdopen(descriptor, "rb");
  if (!gzip_) {
    ::close(descriptor);
    throw std::bad_alloc();
  }
}

GridSource::~GridSource() { ::gzclose(static_cast<gzFile>(gzip_)); }

void GridSource::refuse(const std::string& what) const {
  throw GridRefused(fmt::format("{}: byte {}: {}", name_, taken_, what));
}

double GridSource::most_bytes() const {
  return ::gzdirect(static_cast<gzFile>(gzip_)) ? file_size_ : kMostOfGzip * file_size_;
}

std::size_t GridSource::fill(char* to, std::size_t n) {
  const int got = ::gzread(static_cast<gzFile>(gzip_), to, static_cast<unsigned>(n));
  int error = Z_OK;
  const char* what = ::gzerror(static_cast<gzFile>(gzip_), &error);
  if (error == Z_ERRNO)
    throw std::system_error(errno ? errno : EIO, std::generic_category(), name_ + ": cannot be read");
  if (got < 0 || (error != Z_OK && error != Z_STREAM_END && error != Z_BUF_ERROR)) {
    refuse(fmt::format("damaged gzip data: {}", what));
  }
  return static_cast<std::size_t>(got);
}

/// Reads on. False at the end.
bool GridSource::more() {
  buffer_.erase(0, next_);
  next_ = 0;
  const std::size_t before = buffer_.size();
  buffer_.resize(before + kPiece);
  buffer_.resize(before + fill(buffer_.data() + before, kPiece));
  return buffer_.size() > before;
}

std::string_view GridSource::head() {
  while (buffer_.size() < kHead && more()) continue;
  return std::string_view(buffer_).substr(0, kHead);
}

std::string GridSource::take(std::uint64_t n) {
  std::string taken;
  while (taken.size() < n) {
    if (next_ == buffer_.size() && !more()) {
      refuse(fmt::format("the file is cut: {} bytes are missing", n - taken.size()));
    }
    const std::size_t now = std::min<std::uint64_t>(n - taken.size(), buffer_.size() - next_);
    taken.append(buffer_, next_, now);
    next_ += now;
    taken_ += now;
  }
  return taken;
}

std::string GridSource::until(char stop, std::uint64_t most) {
  std::string taken;
  while (true) {
    if (next_ == buffer_.size() && !more()) refuse("the file is cut");
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

std::string GridSource::line() {
  if (next_ == buffer_.size() && !more()) refuse("the file is cut");
  std::string taken = until('\n', kLongestLine);
  if (!taken.empty() && taken.back() == '\r') taken.pop_back();
  return taken;
}

void GridSource::skip(std::uint64_t n) {
  while (n > 0) {
    const std::uint64_t now = std::min<std::uint64_t>(n, kPiece);
    take(now);
    n -= now;
  }
}

void GridSource::skip_to(char stop) {
  while (next_ < buffer_.size() || more()) {
    const std::size_t end = std::min(buffer_.find(stop, next_), buffer_.size());
    taken_ += end - next_;
    next_ = end;
    if (next_ < buffer_.size()) return;
  }
  refuse("the file is cut");
}

void GridSource::skip_while(std::string_view characters) {
  while ((next_ < buffer_.size() || more()) && characters.find(buffer_[next_]) != std::string_view::npos) {
    ++next_, ++taken_;
  }
}

void GridSource::unpack_rest() {
  if (!::gzdirect(static_cast<gzFile>(gzip_))) refuse("gzip within gzip");
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
  ::gzclose(static_cast<gzFile>(gzip_));
  gzip_ = packed;
  buffer_.clear();
  next_ = 0;
  if (!more() || ::gzdirect(packed)) refuse("the data are said to be of gzip, and are not");
}

void GridSource::require_nodes(const std::vector<std::int64_t>& counts, double bytes_each) {
  double n = 1;
  for (const std::int64_t count : counts) {
    if (count < 1 || count > std::numeric_limits<int>::max()) refuse("a number of nodes that is none");
    n *= static_cast<double>(count);
  }
  if (n * bytes_each > most_bytes()) refuse(fmt::format("{:.4g} nodes: the file has no room for so many", n));
  if (n > max_nodes_) {
    refuse(
        fmt::format("{:.4g} nodes, and at most {:.4g} are allowed: take every second one, or a part", n, max_nodes_));
  }
  if (part_ == Part::Head) throw EndOfHead();
}

std::vector<double> GridSource::take_numbers(std::uint64_t n, NumberType type, bool swap) {
  std::vector<double> numbers;
  const std::uint64_t at_once = kPiece / 8;
  while (numbers.size() < n) {
    append_numbers(take(std::min(at_once, n - numbers.size()) * static_cast<std::uint64_t>(type.bytes)), type, swap,
                   numbers);
  }
  return numbers;
}

std::vector<double> GridSource::take_words(std::uint64_t n) {
  std::vector<double> numbers;
  std::string word;
  while (numbers.size() < n) {
    const bool ended = next_ == buffer_.size() && !more();
    const char c = ended ? ' ' : buffer_[next_];
    const bool is_tag = c == '<';  // ends the last number of XML, and is not taken
    if (!ended && !is_tag) ++next_, ++taken_;
    if (!is_blank(c) && !is_tag) {
      word.push_back(c);
      if (word.size() > kLongestLine) refuse("a number of more than 64 kB");
      continue;
    }
    if (!word.empty()) numbers.push_back(number_of(*this, word));
    word.clear();
    if ((ended || is_tag) && numbers.size() < n)
      refuse(fmt::format("the file is cut: {} numbers are missing", n - numbers.size()));
  }
  return numbers;
}

double number_of(const GridSource& source, std::string_view word) {
  double value = 0;
  const char* const begin = word.data() + (word.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) source.refuse(in_quotes(word) + " is not a number");
  return value;
}

std::int64_t count_of(const GridSource& source, std::string_view word) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size())
    source.refuse(in_quotes(word) + " is not a whole number");
  return value;
}

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; at < text.size();) {
    while (at < text.size() && is_blank(text[at])) ++at;
    std::size_t end = at;
    while (end < text.size() && !is_blank(text[end])) ++end;
    if (end > at) words.push_back(text.substr(at, end - at));
    at = end;
  }
  return words;
}

}  // namespace umtet::detail
