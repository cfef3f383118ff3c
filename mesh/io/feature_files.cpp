#include "mesh/io/feature_files.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "mesh/io/polylines.h"

namespace umtet {

void write_features(const std::filesystem::path& file, const PiecewiseMesh& mesh, const Vec3& shift) {
  std::vector<Vec3> points;
  std::vector<std::int64_t> vertex, curve, patch_1, patch_2;
  std::vector<double> angle;
  std::vector<std::uint8_t> in_mesh;
  std::vector<std::vector<int>> lines;
  const auto add = [&](std::vector<int>& line, const Vec3& x, int v) {
    line.push_back(static_cast<int>(points.size()));
    points.push_back(x + shift);
    vertex.push_back(v);
  };
  for (std::size_t c = 0; c < mesh.graph.curves.size(); ++c) {
    const FeatureCurve& of_body = mesh.graph.curves[c];
    std::vector<int> line;
    for (const int v : mesh.chains[c]) add(line, mesh.mesh.V[v], v);
    in_mesh.push_back(line.empty() ? 0 : 1);
    if (line.empty())
      for (const Vec3& x : of_body.points) add(line, x, -1);
    lines.push_back(std::move(line));
    curve.push_back(static_cast<std::int64_t>(c) + 1);
    patch_1.push_back(of_body.patches[0] + 1);
    patch_2.push_back(of_body.patches[1] + 1);
    angle.push_back(*std::min_element(of_body.angle_deg.begin(), of_body.angle_deg.end()));
  }
  write_polylines(
      file, points, lines, {{"vertex", vertex}},
      {{"curve", curve}, {"patch_1", patch_1}, {"patch_2", patch_2}, {"angle_deg", angle}, {"in_mesh", in_mesh}});
}

}  // namespace umtet
