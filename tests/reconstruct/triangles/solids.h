#pragma once

// Closed surfaces of triangles, and what is done to them.

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "reconstruct/triangles/face_patches.h"
#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet::test {

/// [0, 1]^3, outward.
inline TriangleMesh cube() {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) mesh.V.emplace_back(i >> 2 & 1, i >> 1 & 1, i & 1);
  for (const auto& [a, b, c, d] : std::initializer_list<std::array<int, 4>>{
           {0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}}) {
    mesh.F.push_back({a, b, c});
    mesh.F.push_back({a, c, d});
  }
  return mesh;
}

/// A box with walls and a floor of this thickness, open above.
inline TriangleMesh open_box(const Vec3& size, double wall) {
  TriangleMesh mesh;
  const auto rectangle = [&](const Vec3& low, const Vec3& high, double z) {
    for (const auto& [x, y] :
         {std::pair(low.x(), low.y()), {high.x(), low.y()}, {high.x(), high.y()}, {low.x(), high.y()}})
      mesh.V.emplace_back(x, y, z);
  };
  const auto face = [&](int a, int b, int c, int d) {
    mesh.F.push_back({a, b, c});
    mesh.F.push_back({a, c, d});
  };
  const Vec3 outer = Vec3::Zero(), inner = Vec3::Constant(wall), opposite = size - inner;
  rectangle(outer, size, 0);             // 0 .. 3
  rectangle(outer, size, size.z());      // 4 .. 7
  rectangle(inner, opposite, size.z());  // 8 .. 11
  rectangle(inner, opposite, wall);      // 12 .. 15
  face(3, 2, 1, 0);
  face(12, 13, 14, 15);
  for (int k = 0; k < 4; ++k) {
    const int next = (k + 1) % 4;
    face(k, next, 4 + next, 4 + k);
    face(4 + k, 4 + next, 8 + next, 8 + k);
    face(8 + k, 8 + next, 12 + next, 12 + k);
  }
  return mesh;
}

/// A prism over a polygon, from z = 0 to its height, outward. The polygon turns left and is triangulated by a fan from
/// its first corner: it is convex, or star-shaped around that corner.
inline TriangleMesh prism(const std::vector<Eigen::Vector2d>& polygon, double height) {
  TriangleMesh mesh;
  const int n = static_cast<int>(polygon.size());
  for (const double z : {0., height})
    for (const auto& p : polygon) mesh.V.emplace_back(p.x(), p.y(), z);
  for (int k = 1; k + 1 < n; ++k) {
    mesh.F.push_back({0, k + 1, k});
    mesh.F.push_back({n, n + k, n + k + 1});
  }
  for (int k = 0; k < n; ++k) {
    const int next = (k + 1) % n;
    mesh.F.push_back({k, next, n + next});
    mesh.F.push_back({k, n + next, n + k});
  }
  return mesh;
}

/// cube() whose side z = 1 has the square [low, high]^2 in it, with two triangles of label 2; all others have label 1.
/// The corners of the square are the vertices 8 to 11, counter-clockwise.
inline TriangleMesh cube_with_imprint(double low = .3, double high = .7) {
  TriangleMesh mesh = cube();
  mesh.F.resize(mesh.F.size() - 2);
  for (const auto& [x, y] : {std::pair{low, low}, {high, low}, {high, high}, {low, high}}) mesh.V.emplace_back(x, y, 1);
  const std::array<int, 4> rim = {1, 5, 7, 3};
  for (int k = 0; k < 4; ++k) {
    const int next = (k + 1) % 4;
    mesh.F.push_back({rim[k], rim[next], 8 + next});
    mesh.F.push_back({rim[k], 8 + next, 8 + k});
  }
  mesh.labels.assign(mesh.F.size(), 1);
  mesh.F.push_back({8, 9, 10});
  mesh.F.push_back({8, 10, 11});
  mesh.labels.insert(mesh.labels.end(), {2, 2});
  return mesh;
}

/// Around z, of radii 1 and .4; 2 n m triangles.
inline TriangleMesh torus(int n = 48, int m = 24) {
  TriangleMesh mesh;
  const double pi = std::numbers::pi;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      const double u = 2 * pi * i / n, v = 2 * pi * j / m, r = 1 + .4 * std::cos(v);
      mesh.V.emplace_back(r * std::cos(u), r * std::sin(u), .4 * std::sin(v));
    }
  const auto at = [&](int i, int j) { return i % n * m + j % m; };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      mesh.F.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.F.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

inline TriangleMesh moved(TriangleMesh mesh, const Vec3& by, double scale = 1) {
  for (Vec3& x : mesh.V) x = scale * x + by;
  return mesh;
}

inline TriangleMesh together(TriangleMesh a, const TriangleMesh& b) {
  const auto n = static_cast<int>(a.V.size());
  a.V.insert(a.V.end(), b.V.begin(), b.V.end());
  for (const Triangle& f : b.F) a.F.push_back({f[0] + n, f[1] + n, f[2] + n});
  return a;
}

inline TriangleMesh inside_out(TriangleMesh mesh) {
  for (std::size_t f = 0; f < mesh.F.size(); ++f) turn_face(mesh, f);
  return mesh;
}

/// Every triangle has corners of its own, off their places by up to `off` along each axis.
inline TriangleMesh split(const TriangleMesh& mesh, double off) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> jitter(-off, off);
  TriangleMesh soup;
  for (const Triangle& f : mesh.F) {
    const auto n = static_cast<int>(soup.V.size());
    for (const int v : f) soup.V.push_back(mesh.V[v] + Vec3(jitter(random), jitter(random), jitter(random)));
    soup.F.push_back({n, n + 1, n + 2});
  }
  return soup;
}

/// About a share p of them turned.
inline TriangleMesh some_turned(TriangleMesh mesh, double p) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> dice(0, 1);
  for (std::size_t f = 0; f < mesh.F.size(); ++f)
    if (dice(random) < p) turn_face(mesh, f);
  return mesh;
}

inline TriangleMesh some_removed(const TriangleMesh& mesh, double p) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> dice(0, 1);
  TriangleMesh rest{mesh.V, {}, {}};
  for (const Triangle& f : mesh.F)
    if (dice(random) >= p) rest.F.push_back(f);
  return rest;
}

}  // namespace umtet::test
