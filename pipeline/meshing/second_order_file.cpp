#include "pipeline/meshing/second_order_file.h"

#include <algorithm>
#include <map>
#include <utility>

#include "pipeline/case/artefact.h"
#include "pipeline/meshing/made_mesh.h"
#include "pipeline/meshing/sample_fields.h"

namespace umtet {
namespace fs = std::filesystem;

namespace {

/// Returns the mid-sides of the edges of these faces; some occur more than once.
std::vector<int> mid_sides_of(const std::vector<Triangle>& faces, const QuadraticTetMesh& mesh) {
  std::vector<std::pair<int, int>> edges;
  for (const Triangle& f : faces) {
    for (int k = 0; k < 3; ++k) edges.push_back(std::minmax({f[k], f[(k + 1) % 3]}));
  }
  std::sort(edges.begin(), edges.end());
  std::vector<int> nodes;
  for (const QuadraticTet& tet : mesh.C) {
    for (int k = 0; k < 6; ++k) {
      const std::pair<int, int> edge = std::minmax({tet[kMidSideEdge[k][0]], tet[kMidSideEdge[k][1]]});
      if (std::binary_search(edges.begin(), edges.end(), edge)) nodes.push_back(tet[4 + k]);
    }
  }
  return nodes;
}

}  // namespace

void write_second_order(const fs::path& file, const Domain& domain, const UmResult& result, const MeshFile& corners,
                        const SecondOrder& second) {
  QuadraticTetMesh mesh = second.mesh;
  for (Vec3& x : mesh.V) x += domain.shift;
  std::map<std::string, FieldValues> point_data = corners.point_data;
  for (auto& [name, any] : point_data) {
    if (is_of_scan(name)) continue;
    std::visit(
        [&](auto& values) {
          using Value = typename std::decay_t<decltype(values)>::value_type;
          if constexpr (std::is_arithmetic_v<Value>) {
            values.resize(mesh.V.size(), std::is_signed_v<Value> ? Value(-1) : Value(0));
          }
        },
        any);
  }
  auto& boundary = std::get<std::vector<std::uint8_t>>(point_data.at("boundary"));
  for (const int m : second.boundary_mid_sides) boundary[m] = 1;
  if (!result.walls.empty()) {
    auto& wall = std::get<std::vector<std::uint8_t>>(point_data.at(kAtWall));
    for (const int m : mid_sides_of(result.walls, mesh)) boundary[m] = wall[m] = 1;
  }
  if (const auto support = point_data.find("support"); support != point_data.end()) {
    set_support(domain, second.mesh.V, second.boundary_mid_sides, std::get<std::vector<double>>(support->second));
  }
  set_sample_fields(domain, second.mesh.V, second.boundary_mid_sides, point_data);
  write_artefact(file, [&](const fs::path& temporary) { write_vtu(temporary, mesh, point_data, corners.cell_data); });
}

}  // namespace umtet
