#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstring>

#include "reconstruct/io/detail/file_bytes.h"
#include "reconstruct/io/detail/text_rows.h"
#include "reconstruct/io/detail/triangles/polygon_soup.h"

namespace umtet::detail {
namespace {

// 80 bytes of anything, a count of 32 bits, 50 bytes a triangle: normal and corners in single precision, two bytes that
// mean nothing.
constexpr std::size_t kHeader = 84, kBytesPerTriangle = 50;

template <class T>
T little_endian(const char* bytes) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes, sizeof(T));
  if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<T>(raw);
}

/// In any case of letters.
bool is_word(std::string_view text, std::string_view word) {
  return text.size() == word.size() && std::equal(word.begin(), word.end(), text.begin(), [](char a, char b) {
           return a == static_cast<char>(std::tolower(static_cast<unsigned char>(b)));
         });
}

bool begins_with_solid(const CloudSource& source) {
  const std::size_t begin = source.bytes.find_first_not_of(" \t\r\n");
  return begin != std::string_view::npos && is_word(source.bytes.substr(begin, 5), "solid");
}

std::size_t announced(const CloudSource& source) { return little_endian<std::uint32_t>(source.bytes.data() + 80); }

/// Exporters write "solid" into the header of binary files, too: their size tells.
bool is_ascii(const CloudSource& source) {
  if (!begins_with_solid(source)) return false;
  return source.size() < kHeader || source.size() != kHeader + kBytesPerTriangle * announced(source);
}

void check_binary_size(const CloudSource& source) {
  if (source.size() < kHeader)
    refuse(source, fmt::format("{} bytes: neither an ascii STL, which begins with 'solid', nor a binary one, whose "
                               "header has {}",
                               source.size(), kHeader));
  const std::size_t n = announced(source), room = (source.size() - kHeader) / kBytesPerTriangle;
  if (n == 0) refuse(source, "byte 80: the header announces 0 triangles: export the surface again");
  if (n > room)
    refuse(source, fmt::format("byte 80: the header announces {} triangles of {} bytes, but {} bytes follow: the file "
                               "is cut short or no STL, export it again",
                               n, kBytesPerTriangle, source.size() - kHeader));
  // A little padding is looked at below.
  if (source.bytes_left_out > 0 && room > n + 1)
    refuse(source, fmt::format("byte 80: the header announces {} triangles, but {} bytes follow, enough for {}: the "
                               "count is wrong or this is no STL, export it again",
                               n, source.size() - kHeader, room));
}

TriangleFile read_binary(const CloudSource& source) {
  check_binary_size(source);
  const std::size_t n = announced(source);
  refuse_surplus(source, kHeader + n * kBytesPerTriangle);
  PolygonSoup soup;
  soup.V.reserve(3 * n);
  soup.corners.reserve(3 * n);
  soup.ends.reserve(n);
  for (std::size_t t = 0; t < n; ++t) {
    const char* at = source.bytes.data() + kHeader + t * kBytesPerTriangle + 12;
    for (int k = 0; k < 3; ++k, at += 12) {
      soup.corners.push_back(static_cast<std::int64_t>(soup.V.size()));
      soup.V.emplace_back(little_endian<float>(at), little_endian<float>(at + 4), little_endian<float>(at + 8));
    }
    soup.ends.push_back(soup.corners.size());
  }
  return triangles_of(source, std::move(soup), "stl binary");
}

/// Statement by statement, a line each.
class AsciiStl {
 public:
  explicit AsciiStl(const CloudSource& source) : source_(source), lines_(source.bytes) {}

  /// @return false: the file ends inside of a solid
  bool read() {
    std::string_view line;
    while (lines_.next_filled(line)) {
      split(line, " \t", words_);
      statement(line);
    }
    return state_ == State::Outside;
  }
  std::size_t line() const { return lines_.line(); }
  PolygonSoup soup;
  NameTable solids;

 private:
  enum class State { Outside, Solid, Facet, Loop, LoopDone };

  bool is(std::size_t word, std::string_view name) const { return word < words_.size() && is_word(words_[word], name); }
  [[noreturn]] void unexpected(const char* expected) {
    refuse(source_, fmt::format("line {}: {} where {} is expected: the file is damaged or no STL, export it again",
                                lines_.line(), in_quotes(words_[0]), expected));
  }
  void statement(std::string_view line);
  void vertex();

  const CloudSource& source_;
  LineReader lines_;
  std::vector<std::string_view> words_;
  State state_ = State::Outside;
  int solid_ = 0;
  std::size_t n_corners_ = 0;
};

void AsciiStl::statement(std::string_view line) {
  switch (state_) {
    case State::Outside: {
      if (!is(0, "solid")) unexpected("'solid'");
      const std::size_t name = std::min(line.find_first_not_of(" \t", line.find_first_not_of(" \t") + 5), line.size());
      solid_ = solids.number_of(line.substr(name));
      state_ = State::Solid;
      return;
    }
    case State::Solid:
      if (is(0, "endsolid")) {
        state_ = State::Outside;
      } else if (is(0, "facet")) {
        state_ = State::Facet;
      } else {
        unexpected("'facet' or 'endsolid'");
      }
      return;
    case State::Facet:
      if (!(is(0, "outer") && is(1, "loop"))) unexpected("'outer loop'");
      n_corners_ = 0;
      state_ = State::Loop;
      return;
    case State::Loop:
      if (is(0, "vertex")) return vertex();
      if (!is(0, "endloop")) unexpected("'vertex' or 'endloop'");
      if (n_corners_ < 3)
        refuse(source_,
               fmt::format("line {}: a facet of {} vertices, three at least make one", lines_.line(), n_corners_));
      soup.ends.push_back(soup.corners.size());
      soup.labels.push_back(solid_);
      state_ = State::LoopDone;
      return;
    case State::LoopDone:
      if (!is(0, "endfacet")) unexpected("'endfacet'");
      state_ = State::Solid;
      return;
  }
}

void AsciiStl::vertex() {
  if (words_.size() != 4)
    refuse(source_, fmt::format("line {}: {} values behind 'vertex', not three", lines_.line(), words_.size() - 1));
  Vec3 x;
  for (int a = 0; a < 3; ++a) x[a] = parse_number(source_, lines_.line(), words_[a + 1]);
  soup.corners.push_back(static_cast<std::int64_t>(soup.V.size()));
  soup.V.push_back(x);
  ++n_corners_;
}

}  // namespace

void check_stl_head(const CloudSource& head) {
  if (!is_ascii(head)) return check_binary_size(head);
  refuse_endless_line(head);
  CloudSource whole_lines = head;
  whole_lines.bytes = head.bytes.substr(0, head.bytes.rfind('\n') + 1);
  AsciiStl(whole_lines).read();
}

TriangleFile read_stl(const CloudSource& source) {
  if (!is_ascii(source)) return read_binary(source);
  AsciiStl stl(source);
  if (!stl.read())
    refuse(source,
           fmt::format("line {}: the file ends before 'endsolid': it is cut short, export it again", stl.line()));
  return triangles_of(source, std::move(stl.soup), "stl ascii", &stl.solids);
}

}  // namespace umtet::detail
