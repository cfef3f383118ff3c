// VTK ImageData in XML: tags up to the first array of numbers that counts, then its block, inline or appended.
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <map>

#include "reconstruct/io/detail/grids/grid_source.h"

namespace umtet::detail {
namespace {

using Attributes = std::map<std::string, std::string, std::less<>>;

constexpr std::uint64_t kMostBetweenTags = 1 << 16;

/// The bytes behind a block: those of the file, or what base64 stands for.
class BlockBytes {
 public:
  BlockBytes(GridSource& source, bool is_base64) : source_(source), is_base64_(is_base64) {}

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
  /// What comes now is encoded for itself.
  void begin_anew() { decoded_.clear(), next_ = 0; }

 private:
  static constexpr std::uint64_t kGroupsAtOnce = 1 << 14;

  /// Groups of four characters.
  void decode(std::uint64_t n_groups) {
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    decoded_.clear();
    next_ = 0;
    if (!is_begun_) source_.skip_while(" \n\r\t");
    is_begun_ = true;
    const std::string text = source_.take(4 * n_groups);
    for (std::size_t at = 0; at < text.size(); at += 4) {
      std::uint32_t bits = 0;
      int n_bytes = 3;
      for (std::size_t k = 0; k < 4; ++k) {
        const char c = text[at + k];
        const std::size_t digit = c == '=' && k > 1 ? 0 : kDigits.find(c);
        if (digit == std::string_view::npos) source_.refuse("a block that is not base64, or not as long as it says");
        n_bytes -= c == '=';
        bits = bits << 6 | static_cast<std::uint32_t>(digit);
      }
      for (int k = 0; k < n_bytes; ++k) decoded_.push_back(static_cast<char>(bits >> (16 - 8 * k) & 0xff));
    }
  }

  GridSource& source_;
  bool is_base64_, is_begun_ = false;
  std::string decoded_;
  std::size_t next_ = 0;  ///< of decoded_
};

class Reader {
 public:
  explicit Reader(GridSource& source) : source_(source) {}

  Grid read() {
    while (!is_done_) {
      source_.until('<', kMostBetweenTags);
      take_tag(source_.until('>', kMostBetweenTags));
    }
    return std::move(grid_);
  }

 private:
  void take_tag(std::string_view tag) {
    if (tag.starts_with('?') || tag.starts_with('!')) return;
    const bool is_closing = tag.starts_with('/');
    if (is_closing) tag.remove_prefix(1);
    if (tag.ends_with('/')) tag.remove_suffix(1);
    const std::string_view name = tag.substr(0, tag.find_first_of(" \t\r\n"));
    if (is_closing) {
      if (name == section_) section_.clear();
      if (name == "VTKFile") source_.refuse("no array of one number a node");
      return;
    }
    const Attributes attributes = attributes_of(tag.substr(name.size()));
    if (name == "VTKFile") take_root(attributes);
    if (name == "ImageData") take_image(attributes);
    if (name == "Piece" && of(attributes, "Extent") != extent_) source_.refuse("a piece that is not the whole");
    if (name == "PointData" || name == "CellData") {
      section_ = name;
      scalars_ = of(attributes, "Scalars");
    }
    if (name == "DataArray") take_array(attributes);
    if (name == "AppendedData") take_appended(attributes);
  }

  static std::string of(const Attributes& attributes, std::string_view key) {
    const auto found = attributes.find(key);
    return found == attributes.end() ? std::string() : found->second;
  }

  Attributes attributes_of(std::string_view text) const {
    Attributes all;
    while (true) {
      const std::size_t begin = text.find_first_not_of(" \t\r\n");
      if (begin == std::string_view::npos) return all;
      const std::size_t equals = text.find('=', begin);
      if (equals == std::string_view::npos || equals + 1 >= text.size()) source_.refuse("a tag that cannot be read");
      const char quote = text[equals + 1];
      const std::size_t end = quote == '"' || quote == '\'' ? text.find(quote, equals + 2) : std::string_view::npos;
      if (end == std::string_view::npos) source_.refuse("an attribute without an end");
      all[std::string(text.substr(begin, equals - begin))] = text.substr(equals + 2, end - equals - 2);
      text.remove_prefix(end + 1);
    }
  }

  void take_root(const Attributes& attributes) {
    if (of(attributes, "type") != "ImageData")
      source_.refuse("ImageData are wanted, not " + in_quotes(of(attributes, "type")));
    swap_ = (of(attributes, "byte_order") != "BigEndian") != (std::endian::native == std::endian::little);
    const std::string header = of(attributes, "header_type"), packer = of(attributes, "compressor");
    if (!header.empty() && header != "UInt32" && header != "UInt64") source_.refuse("header_type: UInt32 or UInt64");
    header_ = {NumberType::Kind::Unsigned, header == "UInt64" ? 8 : 4};
    if (!packer.empty() && packer != "vtkZLibDataCompressor") {
      source_.refuse("compressed by " + in_quotes(packer) + ": save it with zlib, or without compression");
    }
    is_packed_ = !packer.empty();
  }

  void take_image(const Attributes& attributes) {
    extent_ = of(attributes, "WholeExtent");
    const std::vector<std::string_view> ends = words_of(extent_);
    if (ends.size() != 6) source_.refuse("WholeExtent: six numbers are wanted");
    const Vec3 spacing = three(of(attributes, "Spacing"), Vec3::Ones());
    grid_.axes = spacing.asDiagonal();
    if (const std::string direction = of(attributes, "Direction"); !direction.empty()) {
      const std::vector<std::string_view> words = words_of(direction);
      if (words.size() != 9) source_.refuse("Direction: nine numbers are wanted");
      for (int k = 0; k < 9; ++k) grid_.axes(k / 3, k % 3) = number_of(source_, words[static_cast<std::size_t>(k)]);
      grid_.axes = grid_.axes * spacing.asDiagonal();
    }
    Vec3 first;
    for (int k = 0; k < 3; ++k) {
      const std::int64_t begin = count_of(source_, ends[static_cast<std::size_t>(2 * k)]),
                         end = count_of(source_, ends[static_cast<std::size_t>(2 * k + 1)]);
      if (std::abs(begin) > (1 << 30) || end < begin || end > (1 << 30)) source_.refuse("an extent that is none");
      n_.push_back(end - begin + 1);
      first[k] = static_cast<double>(begin);
    }
    grid_.origin = three(of(attributes, "Origin"), Vec3::Zero()) + grid_.axes * first;
  }

  Vec3 three(const std::string& text, const Vec3& otherwise) const {
    if (text.empty()) return otherwise;
    const std::vector<std::string_view> words = words_of(text);
    if (words.size() != 3) source_.refuse(in_quotes(text) + ": three numbers are wanted");
    return {number_of(source_, words[0]), number_of(source_, words[1]), number_of(source_, words[2])};
  }

  /// The first array of one number a node, or the one that is named.
  void take_array(const Attributes& attributes) {
    if (section_.empty() || is_chosen_) return;
    const std::string components = of(attributes, "NumberOfComponents"), name = of(attributes, "Name");
    if ((!components.empty() && components != "1") || (!scalars_.empty() && name != scalars_)) {
      return skip_inline(attributes);
    }
    if (n_.size() != 3) source_.refuse("ImageData are missing");
    const std::optional<NumberType> type = number_type(of(attributes, "type"));
    if (!type) source_.refuse(in_quotes(of(attributes, "type")) + " is no type of numbers");
    type_ = *type;
    is_chosen_ = true;
    if (section_ == "CellData") {
      for (std::int64_t& n : n_) --n;
      grid_.origin += grid_.axes * Vec3::Constant(.5);
    }
    const std::string format = of(attributes, "format");
    source_.require_nodes(n_, format == "ascii" ? kBytesOfWord : is_packed_ ? type->bytes / kMostOfZlib : type->bytes);
    grid_.n = {static_cast<int>(n_[0]), static_cast<int>(n_[1]), static_cast<int>(n_[2])};
    grid_.is_whole = type->kind != NumberType::Kind::Float;
    if (format == "ascii") {
      grid_.values = source_.take_words(grid_.size());
      is_done_ = true;
    } else if (format == "binary") {
      take_block(true);
    } else if (format == "appended") {
      offset_ = count_of(source_, of(attributes, "offset"));
      if (offset_ < 0) source_.refuse("offset: a negative one");
    } else {
      source_.refuse("format: " + in_quotes(format) + " is none of ascii, binary, appended");
    }
  }

  /// Of an array that does not count.
  void skip_inline(const Attributes& attributes) {
    if (of(attributes, "format") == "appended") return;
    source_.skip_to('<');
  }

  void take_appended(const Attributes& attributes) {
    if (!is_chosen_) source_.refuse("no array of one number a node");
    const std::string encoding = of(attributes, "encoding");
    if (encoding != "raw" && encoding != "base64") source_.refuse("AppendedData: encoding raw or base64 is wanted");
    source_.until('_', kMostBetweenTags);
    source_.skip(static_cast<std::uint64_t>(offset_));
    take_block(encoding == "base64");
  }

  /// A count of bytes and the bytes; or counts of blocks and of their bytes, and the blocks, each of zlib.
  void take_block(bool is_base64) {
    BlockBytes bytes(source_, is_base64);
    const std::uint64_t n_bytes = grid_.size() * static_cast<std::uint64_t>(type_.bytes);
    is_done_ = true;
    if (!is_packed_) {
      if (take_count(bytes) != static_cast<double>(n_bytes)) source_.refuse("a block that is not as long as its nodes");
      constexpr std::uint64_t kAtOnce = 1 << 20;
      for (std::uint64_t left = n_bytes; left > 0; left -= std::min(left, kAtOnce)) {
        append_numbers(bytes.take(std::min(left, kAtOnce)), type_, swap_, grid_.values);
      }
      return;
    }
    const double n_blocks = take_count(bytes), of_block = take_count(bytes), of_last = take_count(bytes);
    const double whole = n_blocks * of_block - (of_last > 0 ? of_block - of_last : 0);
    if (whole != static_cast<double>(n_bytes) || !(of_block > 0) || of_last > of_block) {
      source_.refuse("a block that is not as long as its nodes");
    }
    std::vector<double> packed;
    for (double k = 0; k < n_blocks; ++k) packed.push_back(take_count(bytes));
    bytes.begin_anew();
    std::string rest;  // a number may lie across two blocks
    for (double k = 0; k < n_blocks; ++k) {
      const double size = k + 1 == n_blocks && of_last > 0 ? of_last : of_block;
      rest += unpacked(bytes, packed[static_cast<std::size_t>(k)], size);
      const std::size_t whole_numbers = rest.size() / type_.bytes * type_.bytes;
      append_numbers(std::string_view(rest).substr(0, whole_numbers), type_, swap_, grid_.values);
      rest.erase(0, whole_numbers);
    }
  }

  double take_count(BlockBytes& bytes) {
    std::vector<double> one;
    append_numbers(bytes.take(static_cast<std::uint64_t>(header_.bytes)), header_, swap_, one);
    if (one.front() > kMostBytes) source_.refuse("a count that is none");
    return one.front();
  }

  std::string unpacked(BlockBytes& bytes, double n_packed, double size) {
    if (!(size <= n_packed * kMostOfZlib)) source_.refuse("a block that is longer than its bytes can be");
    const std::string packed = bytes.take(static_cast<std::uint64_t>(n_packed));
    std::string made(static_cast<std::size_t>(size), '\0');
    uLongf n = made.size();
    if (::uncompress(reinterpret_cast<Bytef*>(made.data()), &n, reinterpret_cast<const Bytef*>(packed.data()),
                     packed.size()) != Z_OK ||
        n != made.size()) {
      source_.refuse("damaged zlib data");
    }
    return made;
  }

  static constexpr double kMostBytes = 1e15;
  static constexpr double kMostOfZlib = 1032;  // bytes that one byte can stand for

  GridSource& source_;
  Grid grid_;
  std::vector<std::int64_t> n_;
  std::string extent_, section_, scalars_;
  NumberType header_{NumberType::Kind::Unsigned, 4}, type_{NumberType::Kind::Float, 8};
  bool swap_ = false, is_packed_ = false, is_chosen_ = false, is_done_ = false;
  std::int64_t offset_ = 0;
};

}  // namespace

Grid read_image_data(GridSource& source) { return Reader(source).read(); }

}  // namespace umtet::detail
