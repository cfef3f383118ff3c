#include "reconstruct/io/feature_lines_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <string_view>
#include <utility>

#include "reconstruct/io/detail/extent.h"
#include "reconstruct/io/detail/file_bytes.h"
#include "reconstruct/io/detail/triangles/line_readers.h"

namespace umtet {
namespace {

using detail::CloudSource;

// Bytes: 30 million points in text, far more than a surface has edges of that kind.
constexpr std::size_t kLargest = std::size_t{1} << 30;
// First words of OBJ files.
constexpr std::string_view kOfObj[] = {"v", "vt", "vn", "l", "g", "o", "s", "mtllib", "usemtl"};

FeatureLinesFile parse(const CloudSource& source) {
  constexpr std::string_view kBlank = " \t\r\n";
  const std::string_view bytes = source.bytes;
  const std::size_t begin = bytes.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) detail::refuse(source, "the file is empty");
  const std::string_view content = bytes.substr(begin);
  if (content.starts_with("feat")) return detail::read_feat(source);
  if (content.starts_with("FoamFile") || content.starts_with("/*") || content.starts_with("//"))
    return detail::read_emesh(source);
  const std::string_view word = content.substr(0, content.find_first_of(kBlank));
  if (word[0] == '#' || std::find(std::begin(kOfObj), std::end(kOfObj), word) != std::end(kOfObj))
    return detail::read_obj_lines(source);
  detail::refuse(
      source,
      "no lines: it begins like none of .feat (its first word is feat), .eMesh (FoamFile) and .obj (v, l, g, "
      "o or a comment)");
}

}  // namespace

void detail::add_point(const CloudSource& source, std::size_t line, const Vec3& x, FeatureLinesFile& lines) {
  if (!(x.allFinite() && x.cwiseAbs().maxCoeff() <= kFarthest))
    refuse(source, fmt::format("line {}: a coordinate is NaN, infinite or beyond 1e50: export the file again", line));
  if (lines.lines.points.size() >= std::numeric_limits<int>::max()) refuse(source, "more than 2147483647 points");
  lines.lines.points.push_back(x);
  lines.line_of_point.push_back(line);
}

FeatureLinesFile read_feature_lines(const std::filesystem::path& file) { return read_feature_lines(InputFile(file)); }

FeatureLinesFile read_feature_lines(const InputFile& file) {
  detail::FileBytes bytes(file);
  if (const CloudSource head = bytes.source(false); head.size() > kLargest)
    detail::refuse(head, fmt::format("{} bytes, more than 2^30: too large for a file of edges", head.size()));
  bytes.read_rest();
  const CloudSource source = bytes.source(false);
  FeatureLinesFile made = parse(source);
  if (made.lines.segments.empty()) detail::refuse(source, "no line of two points or more: export the edges again");
  return made;
}

std::size_t add_lines(TriangleMesh& mesh, const FeatureLinesFile& lines, const std::filesystem::path& file) {
  FollowedLines followed = follow_lines(mesh, lines.lines);
  if (followed.fault) {
    throw CloudRefused(fmt::format("{}: line {}: {}", file.string(), lines.line_of_point[followed.fault->point],
                                   followed.fault->what));
  }
  mesh.lines.insert(mesh.lines.end(), followed.lines.begin(), followed.lines.end());
  return followed.n_edges;
}

}  // namespace umtet
