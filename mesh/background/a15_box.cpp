#include "mesh/background/a15_box.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>

#include "mesh/background/tiling.h"
#include "mesh/base/id_set.h"

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
  const Place sides = {kParts * n[0] + 1, kParts * n[1] + 1, kParts * n[2] + 1};  // places along the edges of the box
  const auto id = [&](const Place& p) { return p[0] + sides[0] * (p[1] + sides[1] * p[2]); };
  IdSet used(sides[0] * sides[1] * sides[2]);
  std::size_t n_tets = 0;
  for_each_tet(n, [&](const auto& corners) {
    for (const Place& p : corners) used.insert(id(p));
    ++n_tets;
  });

  TetMesh mesh;
  const std::size_t n_vertices = used.index();  // and prepares rank()
  mesh.V.reserve(n_vertices);
  used.for_each([&](std::int64_t v) {
    const Place p = {v % sides[0], v / sides[0] % sides[1], v / (sides[0] * sides[1])};
    Vec3 x;
    for (int a = 0; a < 3; ++a) {
      // The walls get the box's own numbers.
      const double share = static_cast<double>(p[a]) / static_cast<double>(kParts * n[a]);
      x[a] = p[a] == kParts * n[a] ? box.max()[a] : box.min()[a] + share * box.sizes()[a];
    }
    mesh.V.push_back(x);
  });
  mesh.C.reserve(n_tets);
  for_each_tet(n, [&](const auto& p) {
    mesh.C.push_back({used.rank(id(p[0])), used.rank(id(p[1])), used.rank(id(p[2])), used.rank(id(p[3]))});
  });
  return mesh;
}

}  // namespace umtet
