#include "mesh/a15_box.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "mesh/tiling.h"

namespace umtet {
namespace {

// All points of A15 are at multiples of a quarter cell.
constexpr std::int64_t kParts = 4;

using Place = std::array<std::int64_t, 3>;  // in quarter cells

/// True if the tet has no volume.
bool is_flat(const std::array<Place, 4>& p) {
  std::array<Place, 3> e;
  for (int k = 0; k < 3; ++k) {
    for (int a = 0; a < 3; ++a) e[k][a] = p[k + 1][a] - p[0][a];
  }
  return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) - e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
             e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]) ==
         0;
}

/// Every tet of A15 that reaches into n cells, its corners moved to the walls where they are beyond: a tet outside
/// becomes flat and is left out.
template <class F>
void for_each_tet(const std::array<std::int64_t, 3>& n, const F& f) {
  for (std::int64_t k = -1; k <= n[2]; ++k) {
    for (std::int64_t j = -1; j <= n[1]; ++j) {
      for (std::int64_t i = -1; i <= n[0]; ++i) {
        const Place cell = {i, j, k};
        for (const auto& tet : a15().tets) {
          std::array<Place, 4> corners;
          for (int c = 0; c < 4; ++c) {
            for (int a = 0; a < 3; ++a) {
              const auto part = static_cast<std::int64_t>(kParts * a15().points[tet[c].type][a]);
              corners[c][a] = std::clamp<std::int64_t>(kParts * (cell[a] + tet[c].offset[a]) + part, 0, kParts * n[a]);
            }
          }
          if (!is_flat(corners)) f(corners);
        }
      }
    }
  }
}

}  // namespace

TetMesh a15_box(const Box& box, double h) {
  if (!(h > 0)) throw std::invalid_argument("h = " + std::to_string(h) + ": must be > 0");
  if (box.isEmpty() || !(box.sizes().minCoeff() > 0) || !box.sizes().allFinite()) {
    throw std::invalid_argument("box: must be finite and not empty");
  }
  const Eigen::Array3d cells = (box.sizes().array() * (a15().mean_edge / h)).round().max(1);
  if (static_cast<double>(a15().tets.size()) * (cells + 2).prod() > std::numeric_limits<int>::max()) {
    throw std::invalid_argument("h = " + std::to_string(h) + ": more than 2^31 - 1 tets in the box");
  }
  std::array<std::int64_t, 3> n;
  for (int a = 0; a < 3; ++a) n[a] = static_cast<std::int64_t>(cells[a]);
  const auto key = [&](const Place& p) { return p[0] + (kParts * n[0] + 1) * (p[1] + (kParts * n[1] + 1) * p[2]); };
  std::vector<std::int64_t> keys;
  for_each_tet(n, [&](const auto& corners) {
    for (const Place& p : corners) keys.push_back(key(p));
  });
  std::vector<std::int64_t> vertices = keys;
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());

  TetMesh mesh;
  for (const std::int64_t v : vertices) {
    const std::int64_t row = v / (kParts * n[0] + 1);
    const Place p = {v % (kParts * n[0] + 1), row % (kParts * n[1] + 1), row / (kParts * n[1] + 1)};
    Vec3 x;
    for (int a = 0; a < 3; ++a) {
      // The walls get the box's own numbers.
      const double share = static_cast<double>(p[a]) / static_cast<double>(kParts * n[a]);
      x[a] = p[a] == kParts * n[a] ? box.max()[a] : box.min()[a] + share * box.sizes()[a];
    }
    mesh.V.push_back(x);
  }
  mesh.C.resize(keys.size() / 4);
  for (std::size_t c = 0; c < keys.size(); ++c) {
    const auto at = std::lower_bound(vertices.begin(), vertices.end(), keys[c]);
    mesh.C[c / 4][c % 4] = static_cast<int>(at - vertices.begin());
  }
  return mesh;
}

}  // namespace umtet
