#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>

#include "reconstruct/io/detail/extent.h"
#include "reconstruct/io/detail/text_rows.h"
#include "reconstruct/io/detail/triangles/line_readers.h"
#include "reconstruct/io/detail/triangles/polygon_soup.h"

namespace umtet::detail {
namespace {

// Of a damaged or binary file a line may be gigabytes; a face of kMostCorners has less.
constexpr std::size_t kLongestLine = 1 << 16;

// What is no surface of polygons, or only looks. Files that are named here are never opened.
constexpr std::string_view kSteppedOver[] = {
    "vt",       "vn",   "vp",         "s",         "p",     "mg",    "mtllib", "usemap", "maplib", "bevel", "c_interp",
    "d_interp", "lod",  "shadow_obj", "trace_obj", "ctech", "stech", "cstype", "deg",    "bmat",   "step",  "curv",
    "curv2",    "surf", "parm",       "trim",      "hole",  "scrv",  "sp",     "end",    "con"};

class ObjReader {
 public:
  /// @param keeps_lines  false: malformed statements l are skipped
  explicit ObjReader(const CloudSource& source, bool keeps_lines = false)
      : source_(source), keeps_lines_(keeps_lines), lines_(source.bytes) {}
  void read();
  PolygonSoup soup;
  NameTable groups, materials, objects;
  std::vector<int> group_of, material_of, object_of;  ///< of each face
  /// A segment of a statement l: indices into soup.V, which may be too large, and the line of the file.
  struct Segment {
    std::int64_t a, b;
    std::size_t line;
  };
  std::vector<Segment> segments;

 private:
  void statement();
  void vertex();
  void face();
  void polyline();
  std::int64_t corner(std::string_view word);
  /// All behind the keyword.
  std::string rest() const { return fmt::format("{}", fmt::join(words_.begin() + 1, words_.end(), " ")); }
  std::size_t line() const { return lines_.line(); }

  const CloudSource& source_;
  const bool keeps_lines_;
  LineReader lines_;
  std::vector<std::string_view> words_;
  int group_ = 0, material_ = 0, object_ = 0;
};

void ObjReader::read() {
  group_ = groups.number_of("default");  // by its definition
  material_ = materials.number_of("");
  object_ = objects.number_of("");
  std::string_view line;
  std::string joined;
  while (lines_.next_filled(line)) {
    if (line.ends_with('\\')) {
      joined.clear();
      while (line.ends_with('\\')) {
        joined.append(line.substr(0, line.size() - 1)).append(" ");
        if (joined.size() > kLongestLine || !lines_.next(line)) break;
      }
      if (!line.ends_with('\\')) joined.append(line);
      line = joined;
    }
    if (line.size() > kLongestLine)
      refuse(source_, fmt::format("line {}: more than {} bytes long: this is no OBJ", lines_.line(), kLongestLine));
    split(line, " \t", words_);
    if (!words_.empty() && words_[0][0] != '#') statement();
  }
}

void ObjReader::statement() {
  const std::string_view word = words_[0];
  if (word == "v") return vertex();
  if (word == "f" || word == "fo") return face();
  if (word == "l") {
    try {
      return polyline();
    } catch (const CloudRefused&) {
      if (keeps_lines_) throw;
      return;
    }
  }
  if (word == "g") {
    group_ = groups.number_of(words_.size() > 1 ? rest() : "default");
  } else if (word == "usemtl") {
    material_ = materials.number_of(rest());
  } else if (word == "o") {
    object_ = objects.number_of(rest());
  } else if (std::find(std::begin(kSteppedOver), std::end(kSteppedOver), word) == std::end(kSteppedOver)) {
    refuse(source_, fmt::format("line {}: {} is no statement of OBJ: the file is damaged or of another format", line(),
                                in_quotes(word)));
  }
}

void ObjReader::vertex() {
  if (words_.size() < 4)
    refuse(source_,
           fmt::format("line {}: {} values behind 'v', three at least are a vertex", line(), words_.size() - 1));
  Vec3 x;
  for (int a = 0; a < 3; ++a) x[a] = parse_number(source_, line(), words_[a + 1]);
  soup.V.push_back(x);
}

/// "7", "7/1", "7//3", "7/1/3"; counted from 1, or from the last vertex backwards.
std::int64_t ObjReader::corner(std::string_view word) {
  const std::string_view digits = word.substr(0, word.find('/'));
  std::int64_t index = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
  if (error != std::errc() || end != digits.data() + digits.size() || index == 0)
    refuse(source_, fmt::format("line {}: {} is no index of a vertex: they count from 1, or from -1 backwards", line(),
                                in_quotes(word)));
  const auto n = static_cast<std::int64_t>(soup.V.size());
  if (index < -n)
    refuse(source_, fmt::format("line {}: {} counts back beyond the first of {} vertices: the file is damaged, export "
                                "it again",
                                line(), in_quotes(word), n));
  return index > 0 ? index - 1 : n + index;
}

void ObjReader::face() {
  if (words_.size() < 4)
    refuse(source_,
           fmt::format("line {}: {} corners behind 'f', three at least are a face", line(), words_.size() - 1));
  for (std::size_t k = 1; k < words_.size(); ++k) soup.corners.push_back(corner(words_[k]));
  soup.ends.push_back(soup.corners.size());
  group_of.push_back(group_);
  material_of.push_back(material_);
  object_of.push_back(object_);
}

void ObjReader::polyline() {
  if (words_.size() < 3)
    refuse(source_, fmt::format("line {}: {} points behind 'l', two at least are a line", line(), words_.size() - 1));
  std::int64_t last = corner(words_[1]);
  for (std::size_t k = 2; k < words_.size(); ++k) {
    const std::int64_t next = corner(words_[k]);
    segments.push_back({last, next, line()});
    last = next;
  }
}

/// Without those that no face has, in the order of the faces.
NameTable in_use(const NameTable& all, std::vector<int>& of_face) {
  NameTable used;
  for (int& number : of_face) number = used.number_of(all.names()[number]);
  return used;
}

}  // namespace

void check_obj_head(const CloudSource& head) {
  CloudSource whole_lines = head;
  whole_lines.bytes = head.bytes.substr(0, head.bytes.rfind('\n') + 1);
  ObjReader(whole_lines).read();
}

FeatureLinesFile read_obj_lines(const CloudSource& source) {
  ObjReader obj(source, true);
  obj.read();
  FeatureLinesFile made;
  made.format = "obj";
  std::vector<int> number(obj.soup.V.size(), -1);
  const auto point = [&](std::int64_t v, std::size_t line) {
    if (v >= static_cast<std::int64_t>(number.size()))
      refuse(source,
             fmt::format("line {}: there is no vertex {}, of {} (counted from 1): the file is damaged, export it "
                         "again",
                         line, v + 1, number.size()));
    if (number[v] < 0) {
      number[v] = static_cast<int>(made.lines.points.size());
      add_point(source, line, obj.soup.V[v], made);
    }
    return number[v];
  };
  for (const auto& [a, b, line] : obj.segments) {
    const int p = point(a, line);
    made.lines.segments.push_back({p, point(b, line)});
  }
  return made;
}

TriangleFile read_obj(const CloudSource& source) {
  ObjReader obj(source);
  obj.read();
  NameTable names = in_use(obj.groups, obj.group_of);
  std::vector<int>* labels = &obj.group_of;
  for (const auto& [table, of_face] : {std::pair{&obj.materials, &obj.material_of}, {&obj.objects, &obj.object_of}}) {
    if (names.names().size() > 1) break;
    names = in_use(*table, *of_face);
    labels = of_face;
  }
  obj.soup.labels = std::move(*labels);
  FeatureLines lines;
  for (const auto& [a, b, line] : obj.segments) {
    const auto n = static_cast<std::int64_t>(obj.soup.V.size());
    if (a >= n || b >= n) continue;
    const Vec3 &x = obj.soup.V[a], &y = obj.soup.V[b];
    if (!x.allFinite() || !y.allFinite() || std::max(x.cwiseAbs().maxCoeff(), y.cwiseAbs().maxCoeff()) > kFarthest)
      continue;
    const int at = static_cast<int>(lines.points.size());
    lines.points.insert(lines.points.end(), {x, y});
    lines.segments.push_back({at, at + 1});
  }
  TriangleFile file = triangles_of(source, std::move(obj.soup), "obj", &names);
  FollowedLines followed = follow_lines(file.mesh, lines);
  file.mesh.lines = std::move(followed.lines);
  file.report.n_lines = followed.n_edges;
  file.report.n_lines_ignored = followed.n_faults;
  return file;
}

}  // namespace umtet::detail
