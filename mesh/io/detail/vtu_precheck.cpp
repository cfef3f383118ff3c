#include "mesh/io/detail/vtu_precheck.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mesh/io/detail/mesh_formats.h"

namespace umtet::detail {
namespace {

/// zlib and lz4 expand at most 1032 and 255 times; uncompressed and ascii files never expand.
constexpr std::uint64_t kGreatestRatio = 1032;
constexpr std::uint64_t kMostComponents = 64;

/// Bytes that base64 text stands for, read in groups of four characters. Blanks between them do not count; '=' may end
/// any group, because VTK encodes a header and its data one after the other.
class Base64Text {
 public:
  explicit Base64Text(std::string_view text) : text_(text) {}
  /// Appends the bytes of the next group; false at the end of the text or at a character that is not base64.
  bool next(std::string& bytes);
  bool valid() const { return valid_; }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  bool valid_ = true;
};

int base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

bool Base64Text::next(std::string& bytes) {
  int n = 0, n_pad = 0;
  std::uint32_t group = 0;
  for (; n < 4 && at_ < text_.size(); ++at_) {
    const char c = text_[at_];
    if (is_blank(c)) continue;
    const int digit = c == '=' ? 0 : base64_digit(c);
    n_pad += c == '=';
    valid_ = digit >= 0 && (n_pad == 0 || c == '=') && n_pad <= 2;
    if (!valid_) return false;
    group = group << 6 | static_cast<std::uint32_t>(digit);
    ++n;
  }
  if (n == 0) return false;
  valid_ = n == 4;
  if (!valid_) return false;
  for (int k = 0; k < 3 - n_pad; ++k) bytes.push_back(static_cast<char>(group >> (16 - 8 * k)));
  return true;
}

class TagWalk {
 public:
  TagWalk(const std::filesystem::path& path, std::string_view bytes) : path_(path), bytes_(bytes) {}
  void run();
  /// A byte each at least, before it was compressed.
  std::uint64_t most_values() const { return bytes_.size() * ratio_; }

 private:
  [[noreturn]] void refuse(std::size_t at, const std::string& reason) const {
    throw MeshFileRefused(path_, "byte " + std::to_string(at), reason);
  }
  void take_attributes(std::size_t at, std::string_view tag);
  std::string_view attribute(std::string_view name) const;
  std::uint64_t count(std::size_t at, std::string_view name) const;
  void open(std::size_t at, std::string_view tag);
  void close(std::size_t at, std::string_view name);
  template <class More>
  std::uint64_t check_header(std::size_t at, std::uint64_t room, std::string& bytes, const More& more) const;
  void check_block(std::size_t at, std::string_view text) const;
  void check_appended(std::size_t at, bool raw) const;
  std::size_t after_comment(std::size_t at, std::string_view opening, std::string_view closing) const;

  const std::filesystem::path& path_;
  std::string_view bytes_;
  std::vector<std::string_view> open_;
  std::vector<std::pair<std::string_view, std::string_view>> attributes_;  ///< names and values of the last tag
  std::uint64_t n_tuples_ = 0;
  std::uint64_t ratio_ = 1;
  std::size_t header_word_ = 4;  ///< bytes of a number in front of a binary block
  bool big_endian_ = false;
  std::vector<std::uint64_t> offsets_;  ///< of arrays in the appended data
  bool has_root_ = false;
};

std::string_view name_of(std::string_view tag) { return tag.substr(0, tag.find_first_of(" \t\r\n/")); }

/// What the parser behind VTK would see, or a refusal: it decodes references to characters, and '>' may be quoted.
void TagWalk::take_attributes(std::size_t at, std::string_view tag) {
  constexpr const char* kBlanks = " \t\r\n";
  attributes_.clear();
  std::string_view rest = tag.substr(name_of(tag).size());
  const auto skip_blanks = [&] { rest.remove_prefix(std::min(rest.find_first_not_of(kBlanks), rest.size())); };
  for (skip_blanks(); !rest.empty() && rest != "/"; skip_blanks()) {
    const std::string_view name = rest.substr(0, rest.find_first_of(" \t\r\n=\"'/"));
    rest.remove_prefix(name.size());
    skip_blanks();
    if (!name.empty() && rest.starts_with('=')) {
      rest.remove_prefix(1);
      skip_blanks();
    }
    const bool is_quoted = rest.starts_with('"') || rest.starts_with('\'');
    const std::size_t end = is_quoted ? rest.find(rest.front(), 1) : std::string_view::npos;
    if (name.empty() || end == std::string_view::npos) refuse(at, "attributes that are not name=\"value\"");
    const std::string_view value = rest.substr(1, end - 1);
    if (value.find("&#") != std::string_view::npos) refuse(at, "references to characters are not read");
    attributes_.emplace_back(name, value);
    rest.remove_prefix(end + 1);
  }
}

/// The value of an attribute of the last tag, empty when it is not there.
std::string_view TagWalk::attribute(std::string_view name) const {
  for (const auto& [known, value] : attributes_)
    if (known == name) return value;
  return {};
}

std::uint64_t TagWalk::count(std::size_t at, std::string_view name) const {
  const std::string_view text = attribute(name);
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) refuse(at, std::string(name) + " is not a count");
  return value;
}

void TagWalk::open(std::size_t at, std::string_view tag) {
  const std::string_view name = name_of(tag);
  take_attributes(at, tag);
  if (!has_root_) {
    if (name != "VTKFile" || attribute("type") != "UnstructuredGrid") {
      refuse(at, "not a VTK XML file of type UnstructuredGrid");
    }
    has_root_ = true;
    if (!attribute("compressor").empty()) ratio_ = kGreatestRatio;
    if (attribute("header_type") == "UInt64") header_word_ = 8;
    big_endian_ = attribute("byte_order") == "BigEndian";
  }
  // A point takes at least three numbers, a cell at least its type: a byte each, or 4/3 characters in base64.
  const auto check = [&](std::uint64_t n) {
    if (n > most_values() || n_tuples_ + n > most_values()) {
      refuse(at, std::to_string(n) + " points, cells or tuples: more than the file can hold");
    }
  };
  if (name == "Piece") {
    for (const char* what : {"NumberOfPoints", "NumberOfCells"}) {
      const std::uint64_t n = count(at, what);
      check(n);
      n_tuples_ += n;
    }
  }
  if (name == "DataArray" || name == "Array") {
    if (!attribute("NumberOfTuples").empty()) check(count(at, "NumberOfTuples"));
    if (!attribute("NumberOfComponents").empty()) {
      const std::uint64_t n = count(at, "NumberOfComponents");
      if (n > kMostComponents) refuse(at, "NumberOfComponents = " + std::to_string(n));
    }
    // Whatever the format is called: VTK reads appended data for an offset.
    if (!attribute("offset").empty() || attribute("format") == "appended") offsets_.push_back(count(at, "offset"));
    const std::string_view array = attribute("Name");
    if (array == "faces" || array == "faceoffsets") refuse(at, "polyhedral cells are not read");
  }
  if (tag.back() != '/') open_.push_back(name);
}

/// What is in front of a binary block: the number of its bytes, or of compressed data the number of parts, the size of
/// one before it was compressed, that of the last, and the compressed size of each. VTK divides by the second.
/// @param more  appends some bytes of the block to `bytes`, false at its end
/// @param room  bytes that the block has at most
/// @return bytes that are to follow behind the header, which are not all taken away from `bytes`
template <class More>
std::uint64_t TagWalk::check_header(std::size_t at, std::uint64_t room, std::string& bytes, const More& more) const {
  std::uint64_t n_words = ratio_ == 1 ? 1 : 3, expected = 0;
  const auto word = [&](std::uint64_t i) {
    std::string text = bytes.substr(i * header_word_, header_word_);
    if (big_endian_) std::reverse(text.begin(), text.end());
    std::uint64_t value = 0;
    std::memcpy(&value, text.data(), text.size());
    return value;
  };
  while (bytes.size() < n_words * header_word_ && more()) {
    if (ratio_ == 1 || bytes.size() < header_word_) continue;
    if (word(0) > room) refuse(at, "a block with more parts than bytes");
    n_words = 3 + word(0);
  }
  if (bytes.size() < n_words * header_word_) refuse(at, "a binary block without a header");
  if (ratio_ != 1) {
    const std::uint64_t n_parts = word(0), part = word(1), last = word(2);
    const bool fits = part > 0 && last <= part && (n_parts > 0 ? part <= room * ratio_ : last == 0);
    if (!fits)
      refuse(at, std::to_string(n_parts) + " compressed parts of " + std::to_string(part) + " bytes, the last of " +
                     std::to_string(last));
  }
  for (std::uint64_t i = ratio_ == 1 ? 0 : 3; i < n_words; ++i) {
    if (word(i) > room) refuse(at, "a binary block that is shorter than its header says");
    expected += word(i);
  }
  bytes.erase(0, n_words * header_word_);
  return expected;
}

/// An inline binary block holds what its header says. VTK leaves the rest of an array as malloc returned it otherwise.
void TagWalk::check_block(std::size_t at, std::string_view text) const {
  Base64Text base64(text);
  std::string bytes;
  const std::uint64_t expected = check_header(at, text.size(), bytes, [&] { return base64.next(bytes); });
  std::uint64_t found = bytes.size();
  for (bytes.clear(); base64.next(bytes); bytes.clear()) found += bytes.size();
  if (!base64.valid()) refuse(at, "a binary block that is not base64");
  if (found != expected) {
    refuse(at, "a binary block of " + std::to_string(found) + " bytes whose header says " + std::to_string(expected));
  }
}

/// The same of the blocks behind all tags, raw or in base64, as far as the end of the file. VTK counts offsets from the
/// first byte that is no blank, whether it is the underscore that belongs there or not.
/// @param at  behind the tag
void TagWalk::check_appended(std::size_t at, bool raw) const {
  const std::size_t underscore = bytes_.find_first_not_of(" \t\r\n\v\f", at);
  if (underscore == std::string_view::npos || bytes_[underscore] != '_')
    refuse(at, "appended data without a beginning");
  const std::size_t first = underscore + 1;
  for (const std::uint64_t offset : offsets_) {
    if (offset >= bytes_.size() - first) refuse(at, "an offset beyond the appended data");
    std::string_view rest = bytes_.substr(first + offset);
    Base64Text base64(rest);
    std::string bytes;
    const std::uint64_t expected = check_header(first + offset, rest.size(), bytes, [&] {
      if (!raw) return base64.next(bytes);
      const std::string_view some = rest.substr(0, header_word_);
      bytes += some;
      rest.remove_prefix(some.size());
      return !some.empty();
    });
    if (expected > rest.size()) refuse(first + offset, "a binary block that is shorter than its header says");
  }
}

void TagWalk::close(std::size_t at, std::string_view name) {
  if (open_.empty() || open_.back() != name) refuse(at, "tags do not nest");
  open_.pop_back();
}

std::size_t TagWalk::after_comment(std::size_t at, std::string_view opening, std::string_view closing) const {
  const std::size_t end = bytes_.find(closing, at + opening.size());
  if (end == std::string_view::npos) refuse(at, "a comment without an end");
  // VTK looks for appended data before anything is parsed.
  if (bytes_.substr(at, end - at).find("<AppendedData") != std::string_view::npos) refuse(at, "tags in a comment");
  return end + closing.size();
}

void TagWalk::run() {
  for (std::size_t at = bytes_.find('<'); at != std::string_view::npos;) {
    const std::string_view rest = bytes_.substr(at);
    if (rest.starts_with("<!--")) {
      at = bytes_.find('<', after_comment(at, "<!--", "-->"));
      continue;
    }
    if (rest.starts_with("<?")) {
      at = bytes_.find('<', after_comment(at, "<?", "?>"));
      continue;
    }
    const std::size_t end = rest.find('>');
    if (end == std::string_view::npos || end < 2) refuse(at, "a tag without an end");
    const std::string_view tag = rest.substr(1, end - 1);
    if (tag.front() == '!') refuse(at, "document type declarations are not read");
    if (tag.front() == '/') {
      close(at, name_of(tag.substr(1)));
    } else {
      open(at, tag);
      const bool array = name_of(tag) == "DataArray" || name_of(tag) == "Array";
      if (array && tag.back() != '/' && attribute("format") == "binary") {
        const std::size_t begin = at + end + 1;
        check_block(begin, bytes_.substr(begin, bytes_.find('<', begin) - begin));
      }
    }
    if (tag.starts_with("AppendedData")) {
      // Raw bytes follow that may contain anything; VTK's parser stops here too.
      if (bytes_.find("</VTKFile>", at) == std::string_view::npos) refuse(bytes_.size(), "the file is cut");
      check_appended(at + end + 1, attribute("encoding") == "raw");
      return;
    }
    at = bytes_.find('<', at + end);
  }
  if (!has_root_) refuse(0, "not a VTK XML file");
  if (!open_.empty()) refuse(bytes_.size(), "the file is cut: <" + std::string(open_.back()) + "> is not closed");
}

}  // namespace

std::uint64_t precheck_vtu(const std::filesystem::path& path) {
  const std::string bytes = file_bytes(path, "<VTKFile");
  TagWalk walk(path, bytes);
  walk.run();
  return walk.most_values();
}

}  // namespace umtet::detail
