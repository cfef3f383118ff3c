#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "reconstruct/io/detail/text_rows.h"
#include "reconstruct/io/detail/triangles/polygon_soup.h"

namespace umtet::detail {
namespace {

constexpr std::string_view kKinds[] = {"OFF", "COFF", "NOFF", "CNOFF", "STOFF", "STCOFF", "STNOFF", "STCNOFF"};

/// Behind the byte order mark of some editors, and comments.
class OffReader {
 public:
  explicit OffReader(const CloudSource& source) : source_(source), lines_(source.bytes) {}

  void header();
  /// All that is announced, or what is there of it.
  /// @return false: the file ends before
  bool body();
  /// \throw CloudRefused  more is there than was announced
  void finish();
  std::size_t line() const { return lines_.line(); }
  PolygonSoup soup;

 private:
  bool next();
  void check_counts();

  const CloudSource& source_;
  LineReader lines_;
  std::vector<std::string_view> words_;
  std::uint64_t n_vertices_ = 0, n_faces_ = 0;
};

/// The words of the next line that has some.
bool OffReader::next() {
  std::string_view line;
  while (lines_.next_filled(line)) {
    split(line.substr(0, line.find('#')), " \t", words_);
    if (!words_.empty()) return true;
  }
  return false;
}

void OffReader::header() {
  if (!next()) refuse(source_, "the file is empty");
  if (std::find(std::begin(kKinds), std::end(kKinds), words_[0]) != std::end(kKinds)) {
    if (words_.size() > 1 && words_[1] == "BINARY")
      refuse(source_, "line 1: binary OFF is not read: export ascii, or STL or PLY");
    words_.erase(words_.begin());
  } else if (!parse_count(words_[0])) {
    refuse(source_, fmt::format("line {}: {} is not 'OFF': an OFF file of 3D vertices begins with it", line(),
                                in_quotes(words_[0])));
  }
  if (words_.empty() && !next()) refuse(source_, "the file ends before the numbers of vertices and faces");
  const std::optional<std::uint64_t> v = parse_count(words_[0]),
                                     f = words_.size() > 1 ? parse_count(words_[1]) : std::nullopt;
  if (!v || !f || words_.size() > 3)
    refuse(source_, fmt::format("line {}: {} where the numbers of vertices, faces and edges are expected", line(),
                                in_quotes(words_[0])));
  n_vertices_ = *v;
  n_faces_ = *f;
  check_counts();
}

/// The shortest vertex is "0 0 0", the shortest face "3 0 1 2"; the last line may lack its end.
void OffReader::check_counts() {
  constexpr std::size_t kVertex = 6, kFace = 8;
  const std::size_t left = source_.size() - lines_.offset() + 1;
  if (n_vertices_ > left / kVertex || n_faces_ > left / kFace || n_vertices_ * kVertex + n_faces_ * kFace > left)
    refuse(source_,
           fmt::format("line {}: {} vertices and {} faces are announced, at least {} and {} bytes each, but {} "
                       "bytes are left: the file is cut short or a count is wrong, export it again",
                       line(), n_vertices_, n_faces_, kVertex, kFace, left - 1));
}

bool OffReader::body() {
  for (std::uint64_t v = 0; v < n_vertices_; ++v) {
    if (!next()) return false;
    if (words_.size() < 3)
      refuse(source_, fmt::format("line {}: {} values for vertex {} of {}, not three: the file is damaged", line(),
                                  words_.size(), v + 1, n_vertices_));
    Vec3 x;
    for (int a = 0; a < 3; ++a) x[a] = parse_number(source_, line(), words_[a]);
    soup.V.push_back(x);
  }
  for (std::uint64_t f = 0; f < n_faces_; ++f) {
    if (!next()) return false;
    const std::optional<std::uint64_t> n = parse_count(words_[0]);
    if (!n || *n + 1 > words_.size() || *n > words_.size())
      refuse(source_, fmt::format("line {}: {} values for face {} of {}, of {} corners: the file is damaged", line(),
                                  words_.size() - 1, f + 1, n_faces_, in_quotes(words_[0])));
    for (std::uint64_t k = 0; k < *n; ++k) {
      const std::optional<std::uint64_t> v = parse_count(words_[k + 1]);
      if (!v || *v >= n_vertices_)
        refuse(source_, fmt::format("line {}: {} is no number of one of {} vertices, counted from 0", line(),
                                    in_quotes(words_[k + 1]), n_vertices_));
      soup.corners.push_back(static_cast<std::int64_t>(*v));
    }
    soup.ends.push_back(soup.corners.size());
  }
  return true;
}

void OffReader::finish() {
  if (next())
    refuse(source_, fmt::format("line {}: {} behind the last of {} faces that the header announces: its counts do not "
                                "fit the data, export the file again",
                                line(), in_quotes(words_[0]), n_faces_));
}

}  // namespace

bool begins_as_off(const CloudSource& head) {
  const std::string_view line = head.bytes.substr(0, head.bytes.find_first_of(" \t\r\n"));
  return std::find(std::begin(kKinds), std::end(kKinds), line) != std::end(kKinds);
}

void check_off_head(const CloudSource& head) {
  CloudSource whole_lines = head;
  const std::size_t end = head.bytes.rfind('\n') + 1;
  whole_lines.bytes = head.bytes.substr(0, end);
  whole_lines.bytes_left_out = head.size() - end;
  OffReader off(whole_lines);
  off.header();
  off.body();
}

TriangleFile read_off(const CloudSource& source) {
  OffReader off(source);
  off.header();
  if (!off.body())
    refuse(source, fmt::format("line {}: the file ends before the last face that it announces: it is cut short, export "
                               "it again",
                               off.line()));
  off.finish();
  return triangles_of(source, std::move(off.soup), "off");
}

}  // namespace umtet::detail
