#include "reconstruct/io/detail/grids/vti_precheck.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "reconstruct/io/level_set_io.h"

namespace umtet::detail {
namespace {

/// An opening tag; strict enough that expat cannot read another one in the same bytes.
struct Tag {
  std::string_view name;
  std::map<std::string_view, std::string_view> attributes;

  std::string_view operator[](std::string_view key) const {
    const auto it = attributes.find(key);
    return it == attributes.end() ? std::string_view{} : it->second;
  }
};

class VtiWalk {
 public:
  VtiWalk(std::string file, std::string_view bytes) : file_(std::move(file)), bytes_(bytes) {}
  void run();

 private:
  [[noreturn]] void refuse(const std::string& reason) const {
    throw LevelSetRefused(fmt::format("{}: byte {}: {}", file_, at_, reason));
  }
  Tag parse(std::string_view text) const;
  void open(const Tag& tag);
  void take_extent(std::string_view text);
  void check_block(std::string_view text) const;

  std::string file_;
  std::string_view bytes_;
  std::size_t at_ = 0;
  std::vector<Tag> open_;
  std::string_view extent_;
  std::uint64_t n_nodes_ = 0;
  bool has_root_ = false, has_piece_ = false;
};

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

bool all_blank(std::string_view text) { return text.find_first_not_of(" \t\n\r") == std::string_view::npos; }

/// name key="value" key="value", each key once, without entities.
Tag VtiWalk::parse(std::string_view text) const {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_";
  const auto word = [&] {
    const std::size_t n = std::min(text.find_first_not_of(kLetters), text.size());
    const std::string_view name = text.substr(0, n);
    text.remove_prefix(n);
    return name;
  };
  if (text.find('&') != std::string_view::npos) refuse("an entity in a tag");
  Tag tag{word(), {}};
  while (!all_blank(text)) {
    if (!is_blank(text.front())) refuse("a tag that cannot be read");
    text.remove_prefix(text.find_first_not_of(" \t\n\r"));
    const std::string_view key = word();
    if (key.empty() || !text.starts_with("=\"")) refuse("a tag that cannot be read");
    const std::size_t end = text.find('"', 2);
    if (end == std::string_view::npos) refuse("an attribute without an end");
    if (!tag.attributes.emplace(key, text.substr(2, end - 2)).second) refuse("an attribute that is there twice");
    text.remove_prefix(end + 1);
  }
  return tag;
}

/// "0 n-1 0 n-1 0 n-1"; no more nodes than the file has bytes.
void VtiWalk::take_extent(std::string_view text) {
  extent_ = text;
  n_nodes_ = 1;
  const char *at = text.data(), *end = at + text.size();
  for (int k = 0; k < 6; ++k) {
    while (at != end && *at == ' ') ++at;
    std::uint32_t value = 0;
    const auto [stop, error] = std::from_chars(at, end, value);
    if (error != std::errc() || (k % 2 == 0 && value != 0)) refuse("an extent that is not 0 n 0 n 0 n");
    at = stop;
    if (k % 2 == 1) n_nodes_ *= std::uint64_t{value} + 1;
    if (n_nodes_ > bytes_.size()) refuse("more nodes than the file has bytes");
  }
  if (at != end) refuse("an extent that is not 0 n 0 n 0 n");
}

void VtiWalk::open(const Tag& tag) {
  static const std::map<std::string_view, std::vector<std::string_view>> kParents = {
      {"VTKFile", {""}},
      {"ImageData", {"VTKFile"}},
      {"FieldData", {"ImageData"}},
      {"Piece", {"ImageData"}},
      {"PointData", {"Piece"}},
      {"CellData", {"Piece"}},
      {"DataArray", {"FieldData", "PointData"}}};
  const auto it = kParents.find(tag.name);
  const std::string_view parent = open_.empty() ? std::string_view{} : open_.back().name;
  if (it == kParents.end() || std::find(it->second.begin(), it->second.end(), parent) == it->second.end())
    refuse("not what a level set of this program has here");
  if (tag.name == "VTKFile") {
    if (has_root_ || tag["type"] != "ImageData" || tag["byte_order"] != "LittleEndian" ||
        tag["header_type"] != "UInt64" || !tag["compressor"].empty()) {
      refuse("not a VTK ImageData file of this program");
    }
    has_root_ = true;
  }
  if (tag.name == "ImageData") take_extent(tag["WholeExtent"]);
  if (tag.name == "Piece") {
    if (has_piece_ || tag["Extent"] != extent_) refuse("a piece that is not the whole");
    has_piece_ = true;
  }
  if (tag.name != "DataArray") return;
  if ((tag["type"] != "Float64" && tag["type"] != "Float32") || tag["format"] != "binary" || tag["Name"].empty() ||
      !tag["NumberOfComponents"].empty()) {
    refuse("an array of a kind that a level set does not have");
  }
}

/// Base64 of a 64-bit number of bytes and the bytes, encoded together.
void VtiWalk::check_block(std::string_view text) const {
  constexpr std::size_t kHeader = 12;  // characters that hold the number
  const std::size_t first = std::min(text.find_first_not_of(" \t\n\r"), text.size());
  text.remove_prefix(first);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  std::array<std::uint8_t, 9> header{};
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool pad = c == '=' && (i + 1 == text.size() || (i + 2 == text.size() && text.back() == '='));
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const std::size_t digit = pad ? 0 : kDigits.find(c);
    if (digit == std::string_view::npos) refuse("a block that is not base64");
    for (std::size_t bit = 0; i < kHeader && bit < 6; ++bit) {
      const std::size_t to = 6 * i + bit;
      header[to / 8] = static_cast<std::uint8_t>(header[to / 8] | (digit >> (5 - bit) & 1) << (7 - to % 8));
    }
  }
  std::uint64_t n_bytes = 0;
  for (int k = 7; k >= 0; --k) n_bytes = n_bytes << 8 | header[static_cast<std::size_t>(k)];
  const Tag& array = open_.back();
  const std::uint64_t size = array["type"] == "Float64" ? 8 : 4;
  if (text.size() < kHeader || n_bytes > bytes_.size() || (n_bytes + sizeof n_bytes + 2) / 3 * 4 != text.size())
    refuse("a block that is not as long as it says");
  std::uint64_t n = n_nodes_;
  if (open_[open_.size() - 2].name == "FieldData") {
    const std::string_view tuples = array["NumberOfTuples"];
    const auto [stop, error] = std::from_chars(tuples.data(), tuples.data() + tuples.size(), n);
    if (error != std::errc() || stop != tuples.data() + tuples.size() || n > bytes_.size())
      refuse("NumberOfTuples is no count");
  }
  if (n * size != n_bytes) refuse(fmt::format("a block of {} bytes for {} numbers", n_bytes, n));
}

void VtiWalk::run() {
  constexpr std::string_view kDeclaration = "<?xml version=\"1.0\"?>";
  if (!bytes_.starts_with(kDeclaration)) refuse("not a VTK ImageData file of this program");
  at_ = kDeclaration.size();
  while (at_ < bytes_.size()) {
    const std::size_t begin = std::min(bytes_.find('<', at_), bytes_.size());
    const std::string_view text = bytes_.substr(at_, begin - at_);
    const bool in_array = !open_.empty() && open_.back().name == "DataArray";
    if (in_array) check_block(text);
    if (!in_array && !all_blank(text)) refuse("text outside of arrays");
    at_ = begin;
    if (begin == bytes_.size()) break;
    const std::size_t end = bytes_.find('>', begin);
    if (end == std::string_view::npos) refuse("a tag without an end");
    const std::string_view tag = bytes_.substr(begin + 1, end - begin - 1);
    if (tag.starts_with('/')) {
      if (open_.empty() || tag.substr(1) != open_.back().name) refuse("tags that do not nest");
      open_.pop_back();
    } else {
      const Tag opened = parse(tag);
      open(opened);
      open_.push_back(opened);
    }
    at_ = end + 1;
  }
  if (!has_piece_ || !open_.empty()) refuse("the file is cut");
}

}  // namespace

void precheck_vti(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  if (in.bad())
    throw std::system_error(errno ? errno : EIO, std::generic_category(),
                            fmt::format("{}: cannot be read", path.string()));
  VtiWalk(path.string(), bytes).run();
}

}  // namespace umtet::detail
