#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "mesh/core/tet_mesh.h"
#include "mesh/core/tet_quality.h"

namespace umtet::testing {

/// The tet with its last two vertices exchanged if that makes its volume positive.
inline Tet oriented(const std::vector<Vec3>& V, Tet t) {
  if (volume6(V[t[0]], V[t[1]], V[t[2]], V[t[3]]) < 0) std::swap(t[2], t[3]);
  return t;
}

/// Unit cubes (i, j, k), 0 <= i, j, k < n, for which `keep` is true, each cut into the six tets of Kuhn.
inline TetMesh cubes(int n, const std::function<bool(int, int, int)>& keep) {
  TetMesh mesh;
  std::map<std::array<int, 3>, int> index;
  const auto vertex = [&](std::array<int, 3> x) {
    const auto [it, added] = index.emplace(x, static_cast<int>(mesh.V.size()));
    if (added) mesh.V.emplace_back(x[0], x[1], x[2]);
    return it->second;
  };
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        if (!keep(i, j, k)) continue;
        std::array<int, 3> axes = {0, 1, 2};
        do {
          std::array<int, 3> x = {i, j, k};
          Tet t{};
          t[0] = vertex(x);
          for (int m = 0; m < 3; ++m) {
            ++x[axes[m]];
            t[m + 1] = vertex(x);
          }
          mesh.C.push_back(oriented(mesh.V, t));
        } while (std::next_permutation(axes.begin(), axes.end()));
      }
    }
  }
  return mesh;
}

/// Moves every vertex by up to `amount` along each axis; the same for the same seed.
inline void perturb(TetMesh& mesh, double amount, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-amount, amount);
  for (Vec3& x : mesh.V) x += Vec3(shift(random), shift(random), shift(random));
}

/// The unit sphere as an octahedron whose faces are cut in four `levels` times; vertices are on it to rounding.
inline TetMesh sphere_surface(int levels, std::vector<Triangle>& faces) {
  TetMesh surface;
  surface.V = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  faces = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {1, 0, 5}, {2, 1, 5}, {3, 2, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middle;
    const auto mid = [&](int a, int b) {
      const auto [it, added] = middle.emplace(std::minmax(a, b), static_cast<int>(surface.V.size()));
      if (added) surface.V.push_back((surface.V[a] + surface.V[b]).normalized());
      return it->second;
    };
    std::vector<Triangle> finer;
    for (const Triangle& f : faces) {
      const int a = mid(f[0], f[1]), b = mid(f[1], f[2]), c = mid(f[2], f[0]);
      finer.insert(finer.end(), {{f[0], a, c}, {a, f[1], b}, {c, b, f[2]}, {a, b, c}});
    }
    faces = std::move(finer);
  }
  return surface;
}

/// The unit ball: a layer of prisms between the sphere surface and half its size, and tets to the centre. Boundary
/// vertices are on |x| = 1; `boundary` receives the outer triangles.
inline TetMesh ball(int levels, std::vector<Triangle>& boundary) {
  TetMesh mesh = sphere_surface(levels, boundary);
  const int n = static_cast<int>(mesh.V.size());
  for (int i = 0; i < n; ++i) mesh.V.push_back(0.5 * mesh.V[i]);
  const int centre = static_cast<int>(mesh.V.size());
  mesh.V.emplace_back(0, 0, 0);
  for (const Triangle& f : boundary) {
    Triangle s = f;  // ascending, so that neighbouring prisms cut their common side along the same diagonal
    std::sort(s.begin(), s.end());
    const auto [a, b, c] = s;
    for (const Tet& t : {Tet{a, b, c, c + n}, Tet{a, b, b + n, c + n}, Tet{a, a + n, b + n, c + n},
                         Tet{a + n, b + n, c + n, centre}}) {
      mesh.C.push_back(oriented(mesh.V, t));
    }
  }
  return mesh;
}

}  // namespace umtet::testing
