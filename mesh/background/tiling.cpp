#include "mesh/background/tiling.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <tuple>

namespace umtet {
namespace {

using Offset = std::array<int, 3>;

// Sites of space group Pm-3n (no. 223): 2a, the corner and the centre of the cell, and 6c, two points on each face.
constexpr std::array<std::array<double, 3>, 8> kA15Points = {
    {{0, 0, 0}, {.5, .5, .5}, {.25, .5, 0}, {.75, .5, 0}, {0, .25, .5}, {0, .75, .5}, {.5, 0, .25}, {.5, 0, .75}}};

// Their periodic Delaunay tets; no five points are cospherical, so the set is unique. Verified by
// tests/mesh/background/tiling_test.cpp.
constexpr std::array<std::array<Tiling::Corner, 4>, 46> kA15Tets = {{
    {{{0, {0, 0, 0}}, {2, {0, 0, 0}}, {3, {-1, 0, 0}}, {4, {0, 0, 0}}}},
    {{{0, {0, 1, 1}}, {2, {0, 0, 1}}, {3, {-1, 0, 1}}, {5, {0, 0, 0}}}},
    {{{0, {0, 0, 1}}, {2, {0, 0, 1}}, {4, {0, 0, 0}}, {3, {-1, 0, 1}}}},
    {{{0, {0, 0, 0}}, {2, {0, 0, 0}}, {4, {0, 0, 0}}, {6, {0, 0, 0}}}},
    {{{0, {0, 1, 0}}, {2, {0, 0, 0}}, {5, {0, 0, 0}}, {3, {-1, 0, 0}}}},
    {{{0, {0, 1, 1}}, {2, {0, 0, 1}}, {5, {0, 0, 0}}, {7, {0, 1, 0}}}},
    {{{0, {0, 1, 0}}, {2, {0, 0, 0}}, {6, {0, 1, 0}}, {5, {0, 0, 0}}}},
    {{{0, {0, 0, 0}}, {2, {0, 0, 0}}, {6, {0, 0, 0}}, {7, {0, 0, -1}}}},
    {{{0, {0, 0, 1}}, {2, {0, 0, 1}}, {7, {0, 0, 0}}, {4, {0, 0, 0}}}},
    {{{0, {0, 1, 0}}, {2, {0, 0, 0}}, {7, {0, 1, -1}}, {6, {0, 1, 0}}}},
    {{{0, {1, 0, 1}}, {3, {0, 0, 1}}, {4, {1, 0, 0}}, {7, {0, 0, 0}}}},
    {{{0, {1, 1, 0}}, {3, {0, 0, 0}}, {5, {1, 0, 0}}, {6, {0, 1, 0}}}},
    {{{0, {1, 0, 0}}, {3, {0, 0, 0}}, {6, {0, 0, 0}}, {4, {1, 0, 0}}}},
    {{{0, {1, 1, 0}}, {3, {0, 0, 0}}, {6, {0, 1, 0}}, {7, {0, 1, -1}}}},
    {{{0, {1, 1, 1}}, {3, {0, 0, 1}}, {7, {0, 1, 0}}, {5, {1, 0, 0}}}},
    {{{0, {1, 0, 0}}, {3, {0, 0, 0}}, {7, {0, 0, -1}}, {6, {0, 0, 0}}}},
    {{{0, {0, 0, 0}}, {4, {0, 0, 0}}, {5, {0, -1, 0}}, {6, {0, 0, 0}}}},
    {{{0, {1, 0, 1}}, {4, {1, 0, 0}}, {5, {1, -1, 0}}, {7, {0, 0, 0}}}},
    {{{0, {1, 0, 0}}, {4, {1, 0, 0}}, {6, {0, 0, 0}}, {5, {1, -1, 0}}}},
    {{{0, {0, 0, 1}}, {4, {0, 0, 0}}, {7, {0, 0, 0}}, {5, {0, -1, 0}}}},
    {{{1, {0, 0, 0}}, {2, {0, 0, 0}}, {3, {0, 0, 0}}, {6, {0, 0, 0}}}},
    {{{1, {0, 0, 0}}, {2, {0, 0, 1}}, {3, {0, 0, 1}}, {7, {0, 1, 0}}}},
    {{{1, {0, 0, 0}}, {2, {0, 0, 0}}, {4, {0, 0, 0}}, {5, {0, 0, 0}}}},
    {{{1, {0, 0, 0}}, {2, {0, 0, 1}}, {4, {0, 0, 0}}, {7, {0, 0, 0}}}},
    {{{1, {0, 0, 0}}, {2, {0, 0, 1}}, {5, {0, 0, 0}}, {4, {0, 0, 0}}}},
    {{{1, {0, 0, 0}}, {2, {0, 0, 0}}, {5, {0, 0, 0}}, {6, {0, 1, 0}}}},
    {{{1, {0, 0, 0}}, {2, {0, 0, 0}}, {6, {0, 1, 0}}, {3, {0, 0, 0}}}},
    {{{1, {0, 0, 0}}, {2, {0, 0, 0}}, {6, {0, 0, 0}}, {4, {0, 0, 0}}}},
    {{{1, {0, 0, 0}}, {2, {0, 0, 1}}, {7, {0, 0, 0}}, {3, {0, 0, 1}}}},
    {{{1, {0, 0, 0}}, {2, {0, 0, 1}}, {7, {0, 1, 0}}, {5, {0, 0, 0}}}},
    {{{1, {0, 0, 0}}, {3, {0, 0, 1}}, {4, {1, 0, 0}}, {5, {1, 0, 0}}}},
    {{{1, {0, 0, 0}}, {3, {0, 0, 0}}, {4, {1, 0, 0}}, {6, {0, 0, 0}}}},
    {{{1, {0, 0, 0}}, {3, {0, 0, 0}}, {5, {1, 0, 0}}, {4, {1, 0, 0}}}},
    {{{1, {0, 0, 0}}, {3, {0, 0, 1}}, {5, {1, 0, 0}}, {7, {0, 1, 0}}}},
    {{{1, {0, 0, 0}}, {3, {0, 0, 0}}, {6, {0, 1, 0}}, {5, {1, 0, 0}}}},
    {{{1, {0, 0, 0}}, {3, {0, 0, 1}}, {7, {0, 0, 0}}, {4, {1, 0, 0}}}},
    {{{1, {0, 0, 0}}, {4, {0, 0, 0}}, {6, {0, 0, 0}}, {7, {0, 0, 0}}}},
    {{{1, {0, 0, 0}}, {4, {1, 0, 0}}, {7, {0, 0, 0}}, {6, {0, 0, 0}}}},
    {{{1, {0, 0, 0}}, {5, {1, 0, 0}}, {6, {0, 1, 0}}, {7, {0, 1, 0}}}},
    {{{1, {0, 0, 0}}, {5, {0, 0, 0}}, {7, {0, 1, 0}}, {6, {0, 1, 0}}}},
    {{{2, {0, 0, 0}}, {3, {-1, 0, 0}}, {4, {0, 0, 0}}, {5, {0, 0, 0}}}},
    {{{2, {0, 0, 1}}, {3, {-1, 0, 1}}, {5, {0, 0, 0}}, {4, {0, 0, 0}}}},
    {{{2, {0, 0, 0}}, {3, {0, 0, 0}}, {6, {0, 0, 0}}, {7, {0, 0, -1}}}},
    {{{2, {0, 0, 0}}, {3, {0, 0, 0}}, {7, {0, 1, -1}}, {6, {0, 1, 0}}}},
    {{{4, {0, 0, 0}}, {5, {0, -1, 0}}, {6, {0, 0, 0}}, {7, {0, 0, 0}}}},
    {{{4, {1, 0, 0}}, {5, {1, -1, 0}}, {7, {0, 0, 0}}, {6, {0, 0, 0}}}},
}};

// 54 edges a cell: 6 of length 1/2, 24 of sqrt(5)/4, 24 of sqrt(6)/4.
constexpr double kA15MeanEdge = .5761730800314409;

Offset operator-(const Offset& a, const Offset& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

auto cell_order(const Offset& o, int id) { return std::make_tuple(o[2], o[1], o[0], id); }

/// A face as its corners relative to the cell of the least type, so that translates compare equal.
using FaceKey = std::array<std::tuple<int, int, int, int>, 3>;

std::pair<FaceKey, Offset> canonical(const std::array<Tiling::Corner, 4>& tet, int opposite) {
  std::array<Tiling::Corner, 3> face;
  for (int k = 0, m = 0; k < 4; ++k) {
    if (k != opposite) face[m++] = tet[k];
  }
  std::pair<FaceKey, Offset> best;
  bool first = true;
  const int least = std::min({face[0].type, face[1].type, face[2].type});
  for (const auto& base : face) {
    if (base.type != least) continue;
    FaceKey key;
    for (int m = 0; m < 3; ++m) key[m] = cell_order(face[m].offset - base.offset, face[m].type);
    std::sort(key.begin(), key.end());
    if (first || key < best.first) best = {key, base.offset};
    first = false;
  }
  return best;
}

}  // namespace

const Tiling& a15() {
  static const Tiling tiling{
      "a15", {kA15Points.begin(), kA15Points.end()}, {kA15Tets.begin(), kA15Tets.end()}, kA15MeanEdge, true};
  return tiling;
}

std::span<const std::string_view> tiling_names() {
  static constexpr std::array<std::string_view, 4> names = {"a15", "z", "slab", "cube"};
  return names;
}

const Tiling& tiling_named(std::string_view name) {
  if (name == "a15") return a15();
  if (name == "z") return z_phase();
  if (name == "slab") return acute_slab();
  if (name == "cube") return acute_cube();
  throw std::invalid_argument("no tiling is called " + std::string(name));
}

double mean_edge(const Tiling& tiling, const TilingTables& tables) {
  double sum = 0;
  std::size_t n = 0;
  for (std::size_t type = 0; type < tiling.points.size(); ++type) {
    for (const auto& [other, offset] : tables.link[type]) {
      double square = 0;
      for (int a = 0; a < 3; ++a) {
        const double d = tiling.points[other][a] + offset[a] * tiling.period[a] - tiling.points[type][a];
        square += d * d;
      }
      sum += std::sqrt(square);
      ++n;
    }
  }
  return sum / static_cast<double>(n);
}

std::array<double, 3> overhang(const Tiling& tiling) {
  std::array<double, 3> most = {0, 0, 0};
  for (const auto& tet : tiling.tets) {
    for (const auto& [type, offset] : tet) {
      for (int a = 0; a < 3; ++a) {
        const double x = tiling.points[type][a] + offset[a] * tiling.period[a];
        most[a] = std::max({most[a], -x, x - tiling.period[a]});
      }
    }
  }
  return most;
}

TilingTables tables(const Tiling& tiling) {
  const int n_types = static_cast<int>(tiling.points.size()), n_tets = static_cast<int>(tiling.tets.size());
  TilingTables result{std::vector<std::vector<TilingTables::TetCorner>>(n_types),
                      std::vector<std::vector<Tiling::Corner>>(n_types),
                      std::vector<std::array<TilingTables::TetFace, 4>>(n_tets)};
  struct Side {
    int tet, face;
    Offset base;
  };
  std::map<FaceKey, std::vector<Side>> faces;
  for (int t = 0; t < n_tets; ++t) {
    for (int k = 0; k < 4; ++k) {
      const auto& corner = tiling.tets[t][k];
      result.star[corner.type].push_back({t, Offset{} - corner.offset});
      for (const auto& other : tiling.tets[t]) {
        if (&other != &corner) result.link[corner.type].push_back({other.type, other.offset - corner.offset});
      }
      const auto [key, base] = canonical(tiling.tets[t], k);
      faces[key].push_back({t, k, base});
    }
  }
  for (const auto& [key, sides] : faces) {
    if (sides.size() != 2) throw std::invalid_argument("tiling " + tiling.name + ": a face without exactly two tets");
    for (int s = 0; s < 2; ++s) {
      const Side &here = sides[s], &there = sides[1 - s];
      result.neighbor[here.tet][here.face] = {there.tet, here.base - there.base};
    }
  }
  for (auto& star : result.star) {
    std::sort(star.begin(), star.end(),
              [](const auto& a, const auto& b) { return cell_order(a.offset, a.tet) < cell_order(b.offset, b.tet); });
  }
  for (auto& link : result.link) {
    const auto key = [](const Tiling::Corner& c) { return cell_order(c.offset, c.type); };
    std::sort(link.begin(), link.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
    link.erase(std::unique(link.begin(), link.end(), [&](const auto& a, const auto& b) { return key(a) == key(b); }),
               link.end());
  }
  return result;
}

}  // namespace umtet
