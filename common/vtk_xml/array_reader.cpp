#include "common/vtk_xml/array_reader.h"

#include <fmt/format.h>
#include <lz4.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <utility>

#include "common/in_quotes.h"

namespace umtet::detail {
namespace {

constexpr std::uint64_t kMostComponents = 64;
constexpr std::uint64_t kMostBytes = 1'000'000'000'000'000;
constexpr std::uint64_t kAtOnce = 1 << 20;
constexpr std::size_t kWordsAtOnce = kAtOnce / 8;
constexpr double kBytesOfWord = 2;  // with the blank behind it
constexpr std::uint64_t kMostBeforeUnderscore = 1 << 16;

template <class T>
T number_of(const ByteStream& source, std::string_view word) {
  T value = 0;
  const char* const begin = word.data() + (word.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) source.refuse(in_quotes(word) + " is not a number");
  return value;
}

int base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

}  // namespace

/// Reads the bytes of a block, raw or decoded from base64.
class ArrayReader::BlockBytes {
 public:
  BlockBytes(ByteStream& source, bool is_base64) : source_(source), is_base64_(is_base64) {}

  std::string take(std::uint64_t n) {
    if (!is_base64_) return source_.take(n);
    std::string taken;
    while (taken.size() < n) {
      if (next_ == decoded_.size()) decode(std::min<std::uint64_t>((n - taken.size() + 2) / 3, kGroupsAtOnce));
      const std::size_t now = std::min<std::uint64_t>(n - taken.size(), decoded_.size() - next_);
      taken.append(decoded_, next_, now);
      next_ += now;
    }
    return taken;
  }
  /// The next bytes begin a new base64 sequence.
  void begin_anew() { decoded_.clear(), next_ = 0; }
  /// Nothing is left over: of base64, the bytes of its last group.
  bool is_at_end() const { return next_ == decoded_.size(); }

 private:
  static constexpr std::uint64_t kGroupsAtOnce = 1 << 16;

  /// Groups of four characters. Blanks between them do not count. '=' may end any group, because VTK encodes a header
  /// and its data one after the other.
  void decode(std::uint64_t n_groups) {
    decoded_.clear();
    next_ = 0;
    std::uint32_t bits = 0;
    int n = 0, n_padding = 0;
    for (std::uint64_t left = 4 * n_groups; left > 0;) {
      source_.skip_while(" \n\r\t");
      const std::string text = source_.take(left);
      for (const char c : text) {
        if (is_blank(c)) continue;
        --left;
        const int digit = c == '=' && n > 1 ? 0 : base64_digit(c);
        if (digit < 0 || (n_padding > 0 && c != '=')) {
          source_.refuse("a block that is not base64, or not as long as it says");
        }
        n_padding += c == '=';
        bits = bits << 6 | static_cast<std::uint32_t>(digit);
        if (++n < 4) continue;
        for (int k = 0; k < 3 - n_padding; ++k) decoded_.push_back(static_cast<char>(bits >> (16 - 8 * k) & 0xff));
        bits = 0;
        n = n_padding = 0;
      }
    }
  }

  ByteStream& source_;
  bool is_base64_;
  std::string decoded_;
  std::size_t next_ = 0;  ///< of decoded_
};

void ArrayReader::take_root(const XmlTag& tag, std::string_view type) {
  if (tag.name != "VTKFile") source_.refuse("not a VTK XML file");
  if (tag["type"] != type) {
    source_.refuse(
        fmt::format("not a VTK XML file of type {}: {} are wanted, not {}", type, type, in_quotes(tag["type"])));
  }
  const std::string_view order = tag["byte_order"], header = tag["header_type"], packer = tag["compressor"];
  if (!order.empty() && order != "LittleEndian" && order != "BigEndian") {
    source_.refuse("byte_order: LittleEndian or BigEndian");
  }
  is_big_endian_ = order == "BigEndian";
  if (!header.empty() && header != "UInt32" && header != "UInt64") source_.refuse("header_type: UInt32 or UInt64");
  header_bytes_ = header == "UInt64" ? 8 : 4;
  packer_ = packer == "vtkZLibDataCompressor"  ? Packer::Zlib
            : packer == "vtkLZ4DataCompressor" ? Packer::Lz4
                                               : Packer::None;
  if (!packer.empty() && packer_ == Packer::None) {
    source_.refuse("compressed by " + in_quotes(packer) + ": save it with zlib, or without compression");
  }
}

XmlArray ArrayReader::array(const XmlTag& tag) const {
  XmlArray array;
  array.name = tag["Name"];
  array.type_name = tag["type"];
  array.type = xml_number_type(array.type_name);
  if (tag.has("NumberOfComponents")) array.n_components = tag.count("NumberOfComponents", source_);
  if (array.n_components > kMostComponents) {
    source_.refuse("NumberOfComponents = " + std::to_string(array.n_components));
  }
  const std::string_view format = tag["format"];
  if (format == "appended" || (format.empty() && tag.has("offset"))) {
    array.format = XmlArray::Format::Appended;
    array.offset = tag.count("offset", source_);
  } else if (format == "binary") {
    array.format = XmlArray::Format::Binary;
  } else if (!format.empty() && format != "ascii") {
    source_.refuse("format: " + in_quotes(format) + " is none of ascii, binary, appended");
  }
  return array;
}

std::uint64_t ArrayReader::ratio() const {
  return packer_ == Packer::Zlib ? kMostOfZlib : packer_ == Packer::Lz4 ? kMostOfLz4 : 1;
}

double ArrayReader::least_bytes(const XmlArray& array) const {
  if (array.format == XmlArray::Format::Ascii) return kBytesOfWord;
  return static_cast<double>(array.type ? array.type->bytes : 1) / static_cast<double>(ratio());
}

double ArrayReader::most_values() const { return source_.most_bytes() * static_cast<double>(ratio()); }

void ArrayReader::read(const XmlArray& array, std::optional<std::uint64_t> n, NumberSink sink) {
  if (!array.type) source_.refuse(in_quotes(array.type_name) + " is no type of numbers");
  switch (array.format) {
    case XmlArray::Format::Ascii:
      return read_words(array, n, sink);
    case XmlArray::Format::Binary:
      read_block(array, true, n, sink);
      source_.skip_while(" \n\r\t");
      if (source_.peek() != '<') source_.refuse("a binary block that is longer than its header says");
      return;
    case XmlArray::Format::Appended:
      appended_.push_back({array, n, std::move(sink)});
  }
}

void ArrayReader::read_appended(const XmlTag& tag) {
  const std::string_view encoding = tag["encoding"];
  if (encoding != "raw" && encoding != "base64") source_.refuse("AppendedData: the encoding must be raw or base64");
  source_.skip_while(" \t\r\n\v\f");
  if (source_.take(1) != "_") source_.refuse("appended data without a beginning");
  std::stable_sort(appended_.begin(), appended_.end(),
                   [](const Appended& a, const Appended& b) { return a.array.offset < b.array.offset; });
  const std::uint64_t first = source_.taken();
  for (const Appended& a : appended_) {
    const std::uint64_t at = source_.taken() - first;
    if (a.array.offset < at) source_.refuse("appended arrays that overlap");
    source_.skip(a.array.offset - at);
    read_block(a.array, encoding == "base64", a.n, a.sink);
  }
  appended_.clear();
  has_read_appended_ = true;
}

void ArrayReader::finish() {
  if (!appended_.empty()) source_.refuse("appended arrays, and no appended data");
  if (has_read_appended_ && source_.last().find("</VTKFile>") == std::string::npos) source_.refuse("the file is cut");
}

void ArrayReader::read_words(const XmlArray& array, std::optional<std::uint64_t> n, const NumberSink& sink) {
  const bool as_integers = array.type->kind != NumberType::Kind::Float && sink.integers;
  std::vector<double> doubles;
  std::vector<std::int64_t> integers;
  std::uint64_t n_taken = 0;
  const auto flush = [&] {
    if (as_integers) sink.integers(integers);
    if (!as_integers && sink.doubles) sink.doubles(doubles);
    doubles.clear();
    integers.clear();
  };
  const auto take = [&](std::string_view word) {
    if (as_integers) {
      integers.push_back(number_of<std::int64_t>(source_, word));
    } else {
      doubles.push_back(number_of<double>(source_, word));
    }
    if (integers.size() + doubles.size() == kWordsAtOnce) flush();
    return ++n_taken != n;
  };
  if (n != 0 && !source_.words(take) && n) {
    source_.refuse(fmt::format("the file is cut: {} numbers are missing", *n - n_taken));
  }
  flush();
}

std::uint64_t ArrayReader::take_count(BlockBytes& bytes) const {
  const std::string text = bytes.take(header_bytes_);
  std::uint64_t value = 0;
  for (std::uint64_t k = 0; k < header_bytes_; ++k) {
    const auto byte = static_cast<unsigned char>(text[is_big_endian_ ? k : header_bytes_ - 1 - k]);
    value = value << 8 | byte;
  }
  return value;
}

void ArrayReader::require_length(std::uint64_t n_bytes, std::optional<std::uint64_t> expected) const {
  if (!expected || n_bytes == *expected) return;
  source_.refuse(
      fmt::format("a block that is not as long as its nodes: {} bytes, and {} are needed", n_bytes, *expected));
}

/// A count of bytes and the bytes; or what read_packed() reads.
void ArrayReader::read_block(const XmlArray& array, bool is_base64, std::optional<std::uint64_t> n,
                             const NumberSink& sink) {
  const auto size = static_cast<std::uint64_t>(array.type->bytes);
  if (n && *n > kMostBytes / size) source_.refuse("a count that is none");
  const std::optional<std::uint64_t> expected = n ? std::optional(*n * size) : std::nullopt;
  BlockBytes bytes(source_, is_base64);
  if (packer_ != Packer::None) {
    read_packed(array, bytes, expected, sink);
  } else {
    const std::uint64_t n_bytes = take_count(bytes);
    if (n_bytes > kMostBytes) source_.refuse("a count that is none");
    require_length(n_bytes, expected);
    if (n_bytes % size != 0) source_.refuse("a block that does not end with a number");
    for (std::uint64_t left = n_bytes; left > 0; left -= std::min(left, kAtOnce)) {
      give(bytes.take(std::min(left, kAtOnce)), *array.type, sink);
    }
  }
  if (!bytes.is_at_end()) source_.refuse("a binary block that is longer than its header says");
}

/// Reads compressed blocks. Their header contains the number of blocks, the uncompressed bytes of a block and of the
/// last block (0: as many as the others), and the compressed bytes of each block.
void ArrayReader::read_packed(const XmlArray& array, BlockBytes& bytes, std::optional<std::uint64_t> n_bytes,
                              const NumberSink& sink) {
  const auto most = static_cast<std::uint64_t>(source_.most_bytes());
  const std::uint64_t n_parts = take_count(bytes);
  if (n_parts > most) source_.refuse("a block with more parts than bytes: a count that is none");
  const std::uint64_t part = take_count(bytes), last = take_count(bytes);
  const bool fits = part > 0 && last <= part && (n_parts > 0 ? part <= kMostBytes / n_parts : last == 0);
  if (!fits) {
    source_.refuse(
        fmt::format("{} compressed parts of {} bytes, the last of {}: a count that is none", n_parts, part, last));
  }
  const std::uint64_t whole = n_parts * part - (last > 0 ? part - last : 0);
  require_length(whole, n_bytes);
  std::vector<std::uint64_t> packed;
  for (std::uint64_t k = 0; k < n_parts; ++k) packed.push_back(take_count(bytes));
  bytes.begin_anew();
  std::string rest;  // a number may lie across two parts
  for (std::uint64_t k = 0; k < n_parts; ++k) {
    if (packed[k] > most) source_.refuse("a binary block that is shorter than its header says");
    const std::uint64_t size = k + 1 == n_parts && last > 0 ? last : part;
    if (size / ratio() > packed[k]) source_.refuse("a block that is longer than its bytes can be");
    rest += unpacked(bytes.take(packed[k]), size);
    const std::size_t n_whole = rest.size() / array.type->bytes * array.type->bytes;
    give(std::string_view(rest).substr(0, n_whole), *array.type, sink);
    rest.erase(0, n_whole);
  }
  if (!rest.empty()) source_.refuse("a block that does not end with a number");
}

std::string ArrayReader::unpacked(const std::string& packed, std::uint64_t size) const {
  std::string made(size, '\0');
  if (packer_ == Packer::Lz4) {
    const bool fits = packed.size() < LZ4_MAX_INPUT_SIZE && size < LZ4_MAX_INPUT_SIZE;
    if (!fits || LZ4_decompress_safe(packed.data(), made.data(), static_cast<int>(packed.size()),
                                     static_cast<int>(size)) != static_cast<int>(size)) {
      source_.refuse("damaged LZ4 data");
    }
    return made;
  }
  uLongf n = made.size();
  if (::uncompress(reinterpret_cast<Bytef*>(made.data()), &n, reinterpret_cast<const Bytef*>(packed.data()),
                   packed.size()) != Z_OK ||
      n != made.size()) {
    source_.refuse("damaged zlib data");
  }
  return made;
}

void ArrayReader::give(std::string_view bytes, NumberType type, const NumberSink& sink) const {
  const bool swap = is_big_endian_ != (std::endian::native == std::endian::big);
  const auto size = static_cast<std::size_t>(type.bytes);
  for (std::size_t at = 0; at < bytes.size(); at += kAtOnce) {
    const std::string_view some = bytes.substr(at, kAtOnce / size * size);
    if (type.kind != NumberType::Kind::Float && sink.integers) {
      std::vector<std::int64_t> numbers;
      append_numbers(some, type, swap, numbers);
      sink.integers(numbers);
    } else if (sink.doubles) {
      std::vector<double> numbers;
      append_numbers(some, type, swap, numbers);
      sink.doubles(numbers);
    }
  }
}

}  // namespace umtet::detail
