#include "pipeline/output/diff_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "mesh/certify/boundary_surface.h"
#include "mesh/implicit/surface_distance.h"
#include "mesh/implicit/zero_surface.h"
#include "mesh/io/tet_mesh_io.h"
#include "pipeline/case/artefact.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/domain/load_domain.h"
#include "pipeline/output/detail/triangle_scene.h"
#include "pipeline/output/report_page.h"
#include "pipeline/stages/stages.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

// Faces of a surface in the page, as in a report; cubes along the diagonal of a body for psi = 0.
constexpr std::size_t kMostDiffFaces = 150'000;
constexpr double kDiffCubes = 72;

struct Surface {
  std::vector<Vec3> V;
  std::vector<Triangle> F;
  std::string file;
};

Surface boundary_of(const CasePaths& paths) {
  try {
    TetMesh mesh = read_tet_mesh(paths.mesh()).mesh;
    std::vector<Triangle> faces = boundary_faces(mesh.C, mesh.V.size()).triangles;
    return {std::move(mesh.V), std::move(faces), paths.mesh().string()};
  } catch (const MeshFileRefused& e) {
    throw ArtefactDamaged(e.what());
  }
}

Surface zero_set_of(const CasePaths& paths) {
  Parameters parameters;
  parameters.load(paths.parameters(), ParamSource::Case);
  const Domain domain = load_domain(paths, parameters);
  ZeroSurface zero = zero_surface(domain.psi(), domain.box, domain.diagonal / kDiffCubes, {}, until_interrupted());
  for (Vec3& x : zero.V) x += domain.shift;
  return {std::move(zero.V), std::move(zero.F), paths.folder(Stage::LevelSet).string()};
}

/// Returns the surfaces of the last stage that both cases have, if it differs.
std::optional<std::array<Surface, 2>> surfaces_of(const CasePaths& a, const CasePaths& b, const CaseDiff& diff) {
  const auto stage = [&](Stage s) -> const StageDiff& { return diff.stages[static_cast<std::size_t>(s) - 1]; };
  if (const StageDiff& mesh = stage(Stage::Mesh); mesh.in_a && mesh.in_b) {
    if (mesh.same) return std::nullopt;
    return std::array{boundary_of(a), boundary_of(b)};
  }
  const StageDiff& fit = stage(Stage::LevelSet);
  if (!fit.in_a || !fit.in_b || fit.same) return std::nullopt;
  return std::array{zero_set_of(a), zero_set_of(b)};
}

}  // namespace

bool write_diff_page(const fs::path& file, const CasePaths& a, const CasePaths& b, const CaseDiff& diff) {
  const std::optional<std::array<Surface, 2>> surfaces = surfaces_of(a, b, diff);
  if (!surfaces || (*surfaces)[0].F.empty() || (*surfaces)[1].F.empty()) return false;
  std::array<std::vector<double>, 2> off;
  double most = 0;
  for (const std::size_t k : {0, 1}) {
    const auto& [V, F, name] = (*surfaces)[k];
    const Surface& other = (*surfaces)[1 - k];
    std::vector<Vec3> points;
    const std::vector<int> used = detail::order_of_use(F, V.size());
    for (const int v : used) points.push_back(V[v]);
    const std::vector<double> distance = SurfaceDistance(other.V, other.F).distances(points, until_interrupted());
    off[k].resize(V.size());
    for (std::size_t i = 0; i < used.size(); ++i) off[k][used[i]] = distance[i];
    most = std::max(most, *std::max_element(distance.begin(), distance.end()));
  }
  Json stages = Json::array();
  std::vector<std::pair<std::string, std::string>> blocks;
  for (const std::size_t k : {0, 1}) {
    const Surface& surface = (*surfaces)[k];
    const std::string id = k == 0 ? "a" : "b";
    ReportScene scene = detail::triangle_scene(surface.V, surface.F, Vec3::Zero(), kMostDiffFaces,
                                               {{"distance to the other boundary, model units", off[k], {0, most}}});
    for (auto& [name, text] : scene.blocks) blocks.emplace_back(id + "_" + name, std::move(text));
    const double far = *std::max_element(off[k].begin(), off[k].end());
    stages.push_back(
        {{"id", id},
         {"name", k == 0 ? diff.a : diff.b},
         {"facts", Json::array({Json::array({"farthest from the other boundary", fmt::format("{:.3g}", far)})})},
         {"seconds", nullptr},
         {"file", surface.file},
         {"command", ""},
         {"layers", Json::array()},
         {"colour", "field_0"},
         {"scene", to_json(scene.head)}});
  }
  const Json strip = {{"stages", stages}, {"layers", Json::array()}, {"blame", nullptr}, {"shown", "a"}};
  write_text_artefact(file, report_page({{"title", html_text(diff.a + " and " + diff.b)},
                                         {"verdict", "differs"},
                                         {"made", "umtet diff"},
                                         {"reasons", "<pre class=\"table\">" + html_text(diff_text(diff)) + "</pre>"},
                                         {"shown", "Colours show the distance of each vertex to the other boundary."},
                                         {"strip", script_json(strip)},
                                         {"blocks", blocks_text(blocks)}}));
  return true;
}

}  // namespace umtet
