#include "mesh/submesh/walls.h"

#include <algorithm>
#include <cstddef>

namespace umtet {

std::vector<Triangle> wall_faces(const BackgroundMesh& background, const Submesh& submesh) {
  std::vector<Triangle> faces;
  for (std::size_t t = 0; t < submesh.mesh.C.size(); ++t) {
    for (int k = 0; k < 4; ++k) {
      if (background.neighbor(submesh.background_tet[t], k) >= 0) continue;
      const Tet& tet = submesh.mesh.C[t];
      faces.push_back({tet[kTetFace[k][0]], tet[kTetFace[k][1]], tet[kTetFace[k][2]]});
    }
  }
  return faces;
}

UmEvidence boundary_near_walls(const BackgroundMesh& background, const Submesh& submesh) {
  std::vector<char> near(submesh.mesh.V.size(), 0);
  for (std::size_t i = 0; i < near.size(); ++i) near[i] = background.on_boundary(submesh.background_vertex[i]);
  for (int edge = 0; edge < 2; ++edge) {
    std::vector<char> next = near;
    for (const Tet& tet : submesh.mesh.C) {
      if (std::any_of(tet.begin(), tet.end(), [&](int v) { return near[v]; })) {
        for (const int v : tet) next[v] = 1;
      }
    }
    near.swap(next);
  }
  UmEvidence evidence{.what = "psi = 0 comes within two edges of a wall"};
  for (const int i : submesh.positive_vertices) {
    if (!near[i] || evidence.count++ > 0) continue;
    evidence.background_vertex = submesh.background_vertex[i];
    evidence.where = submesh.mesh.V[i];
  }
  return evidence;
}

}  // namespace umtet
