#include "reconstruct/io/feature_lines_io.h"
#include "tests/fuzz/input_file.h"
#include "tests/reconstruct/triangles/solids.h"

namespace umtet::fuzz {
namespace {

/// Finite points, no more than the file has bytes, and segments between them, whose edges are sides of triangles; or a
/// refusal.
int read_lines(const std::filesystem::path& path, std::size_t size) {
  try {
    const FeatureLinesFile file = read_feature_lines(path);
    const auto n = static_cast<int>(file.lines.points.size());
    require(file.lines.points.size() <= size && file.lines.segments.size() <= size);
    require(file.line_of_point.size() == file.lines.points.size());
    for (const Vec3& x : file.lines.points) require(x.allFinite());
    for (const auto& [a, b] : file.lines.segments) require(a >= 0 && a < n && b >= 0 && b < n);
    const TriangleMesh mesh = test::cube();
    const FollowedLines followed = follow_lines(mesh, file.lines);
    require(followed.fault.has_value() == (followed.n_faults > 0));
    for (const auto& [a, b] : followed.lines) require(a >= 0 && a < b && b < 8);
  } catch (const CloudRefused&) {
  }
  return 0;
}

}  // namespace
}  // namespace umtet::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const umtet::fuzz::InputFile file(".lines");
  return umtet::fuzz::read_lines(file.write(data, size), size);
}
