#include "mesh/submesh/double_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "mesh/submesh/lattice_active_layer.h"

namespace umtet {
namespace {

/// Background ids of the five vertices of each pair of positively cut tets that share a positive face.
std::vector<std::array<std::int64_t, 5>> double_faces(const Submesh& submesh) {
  std::vector<std::pair<Triangle, int>> faces;  // with the tet behind
  for (std::size_t f = 0; f < submesh.positive_faces.size(); ++f) {
    Triangle face = submesh.positive_faces[f];
    std::sort(face.begin(), face.end());
    faces.emplace_back(face, submesh.positive_tets[f]);
  }
  std::sort(faces.begin(), faces.end());
  const auto apex = [&](const std::pair<Triangle, int>& f) {
    const Tet& tet = submesh.mesh.C[f.second];
    return *std::find_if(tet.begin(), tet.end(),
                         [&](int v) { return std::find(f.first.begin(), f.first.end(), v) == f.first.end(); });
  };
  std::vector<std::array<std::int64_t, 5>> found;
  const auto& id = submesh.background_vertex;
  for (std::size_t f = 1; f < faces.size(); ++f) {
    const Triangle& face = faces[f].first;
    if (face != faces[f - 1].first) continue;
    found.push_back({id[face[0]], id[face[1]], id[face[2]], id[apex(faces[f - 1])], id[apex(faces[f])]});
  }
  return found;
}

}  // namespace

std::size_t part_double_faces(const BackgroundMesh& background, ImplicitFunctionRef psi, IdSet& inside,
                              Submesh& submesh) {
  IdSet changed(background.n_vertices());
  std::size_t n_changed = 0;
  for (auto found = double_faces(submesh); !found.empty(); found = double_faces(submesh)) {
    const std::size_t before = n_changed;
    for (const auto& vertices : found) {
      // A pair whose vertex changed with another pair of this round may be parted by that.
      if (std::any_of(vertices.begin(), vertices.end(), [&](std::int64_t v) { return changed.test(v); }) &&
          n_changed > before) {
        continue;
      }
      std::int64_t nearest = -1;
      double least = std::numeric_limits<double>::infinity();
      for (const std::int64_t v : vertices) {
        Vec3 g;
        const double distance = std::abs(psi.value(background.position(v), g)) / g.norm();
        if (!changed.test(v) && !background.on_boundary(v) && distance < least) nearest = v, least = distance;
      }
      if (nearest < 0) continue;
      inside.test(nearest) ? inside.erase(nearest) : inside.insert(nearest);
      changed.insert(nearest);
      ++n_changed;
    }
    if (n_changed == before) break;
    submesh = emit_submesh(background, inside);
  }
  return n_changed;
}

}  // namespace umtet
