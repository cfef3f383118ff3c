#include "mesh/fast/flips/flipped_submesh.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "mesh/core/used_vertices.h"

namespace umtet {
namespace {

// In edges: vertices on psi = 0 are much nearer, those that have stepped back much farther.
constexpr double kOnSurface = 1e-6;

std::vector<VertexStratum> strata(ImplicitFunctionRef psi, double h, const UmResult& result) {
  std::vector<VertexStratum> stratum(result.final.size(), VertexStratum::Inner);
  for (const int v : result.submesh.positive_vertices) {
    Vec3 gradient;
    const double value = psi.value(result.final[v], gradient);
    const bool is_on = std::abs(value) <= kOnSurface * h * gradient.norm();
    stratum[v] = is_on ? VertexStratum::Boundary : VertexStratum::Fixed;
  }
  for (const Triangle& f : result.walls)
    for (const int v : f) stratum[v] = VertexStratum::Fixed;
  return stratum;
}

struct BoundaryFace {
  Triangle key, face;
  int tet;
};

/// Lists the faces that belong to only one tet and are not among the walls, by tet and then by vertices.
void list_positive_faces(const std::vector<Triangle>& walls, Submesh& submesh) {
  // Only faces whose corners all lie on the boundary can be such: few of all.
  std::vector<std::uint8_t> on_boundary(submesh.mesh.V.size(), 0);
  for (const int v : submesh.positive_vertices) on_boundary[v] = 1;
  std::vector<BoundaryFace> faces;
  for (std::size_t t = 0; t < submesh.mesh.C.size(); ++t) {
    for (const auto& f : kTetFace) {
      const Tet& tet = submesh.mesh.C[t];
      const Triangle face = {tet[f[0]], tet[f[1]], tet[f[2]]};
      if (!std::all_of(face.begin(), face.end(), [&](int v) { return on_boundary[v] != 0; })) continue;
      Triangle key = face;
      std::sort(key.begin(), key.end());
      faces.push_back({key, face, static_cast<int>(t)});
    }
  }
  for (const Triangle& wall : walls) {
    Triangle key = wall;
    std::sort(key.begin(), key.end());
    faces.push_back({key, wall, -1});
  }
  std::sort(faces.begin(), faces.end(), [](const BoundaryFace& a, const BoundaryFace& b) {
    return std::pair(a.key, a.tet) < std::pair(b.key, b.tet);
  });
  std::vector<BoundaryFace> alone;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    const bool is_twin =
        (k > 0 && faces[k - 1].key == faces[k].key) || (k + 1 < faces.size() && faces[k + 1].key == faces[k].key);
    if (!is_twin && faces[k].tet >= 0) alone.push_back(faces[k]);
  }
  std::stable_sort(alone.begin(), alone.end(),
                   [](const BoundaryFace& a, const BoundaryFace& b) { return a.tet < b.tet; });
  submesh.positive_faces.clear();
  submesh.positive_tets.clear();
  for (const BoundaryFace& f : alone) {
    submesh.positive_faces.push_back(f.face);
    submesh.positive_tets.push_back(f.tet);
  }
}

}  // namespace

LocalFlipReport flip_submesh(ImplicitFunctionRef psi, double h, const LocalFlipParams& params, UmResult& result,
                             const Context& context) {
  LocalFlipReport report;
  if (result.status != UmStatus::Success) return report;
  FlippedMesh made =
      flip_locally(result.final, result.submesh.mesh.C, strata(psi, h, result), psi, params, report, context);
  result.n_psi_evaluations += report.psi_evaluations;
  if (report.n_collapsed + report.n_removed_edges == 0) {
    result.final = std::move(made.V);
    return report;
  }
  Submesh& now = result.submesh;
  result.of_background = std::make_shared<const UmResult>(result);
  const UsedVertices used(made.C, made.V.size());
  used.keep(now.mesh.V);
  used.keep(now.background_vertex);
  used.keep(result.projected);
  used.keep(made.V);
  result.final = std::move(made.V);
  for (Tet& t : made.C) used.renumber(t);
  for (Triangle& f : result.walls) used.renumber(f);
  std::erase_if(now.positive_vertices, [&](int v) { return used[v] < 0; });
  used.renumber(now.positive_vertices);
  now.mesh.C = std::move(made.C);
  std::vector<std::int64_t> background_tet;
  background_tet.reserve(made.origin.size());
  for (const std::int64_t t : made.origin)
    background_tet.push_back(t < 0 ? -1 : now.background_tet[static_cast<std::size_t>(t)]);
  now.background_tet = std::move(background_tet);
  list_positive_faces(result.walls, now);
  return report;
}

}  // namespace umtet
