#pragma once

#include <array>
#include <functional>
#include <numeric>

#include "mesh/core/tet_mesh.h"

namespace umtet::testing {

/// Cubes of a grid between two corners, each cut into the six tets around its diagonal: a conforming mesh. Vertex
/// (i, j, k) has number i + (n_x + 1) (j + (n_y + 1) k).
inline TetMesh box_tets(const Vec3& from, const Vec3& to, std::array<int, 3> n) {
  TetMesh mesh;
  for (int k = 0; k <= n[2]; ++k) {
    for (int j = 0; j <= n[1]; ++j) {
      for (int i = 0; i <= n[0]; ++i) {
        mesh.V.push_back(from + (to - from).cwiseProduct(Vec3(double(i) / n[0], double(j) / n[1], double(k) / n[2])));
      }
    }
  }
  const std::array<int, 3> stride{1, n[0] + 1, (n[0] + 1) * (n[1] + 1)};
  constexpr std::array<std::array<int, 3>, 6> kPaths = {
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};  // the last three are odd permutations
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) {
        const int v = i + stride[1] * j + stride[2] * k;
        for (std::size_t p = 0; p < 6; ++p) {
          const int a = v + stride[std::size_t(kPaths[p][0])], b = a + stride[std::size_t(kPaths[p][1])],
                    c = b + stride[std::size_t(kPaths[p][2])];
          mesh.C.push_back(p < 3 ? Tet{v, a, b, c} : Tet{v, b, a, c});
        }
      }
    }
  }
  return mesh;
}

/// Numbers of the tets whose centroid is where `inside` says.
inline std::vector<int> tets_where(const TetMesh& mesh, const std::function<bool(const Vec3&)>& inside) {
  std::vector<int> all;
  for (int t = 0; t < int(mesh.C.size()); ++t) {
    Vec3 sum = Vec3::Zero();
    for (const int i : mesh.C[std::size_t(t)]) sum += mesh.V[std::size_t(i)];
    if (inside(sum / 4)) all.push_back(t);
  }
  return all;
}

/// Numbers of the vertices where `inside` says.
inline std::vector<int> vertices_where(const TetMesh& mesh, const std::function<bool(const Vec3&)>& inside) {
  std::vector<int> all;
  for (int i = 0; i < int(mesh.V.size()); ++i) {
    if (inside(mesh.V[std::size_t(i)])) all.push_back(i);
  }
  return all;
}

}  // namespace umtet::testing
