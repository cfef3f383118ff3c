#include "mesh/regions/detail/torus_mesh.h"

#include <algorithm>
#include <map>
#include <unordered_map>
#include <utility>

#include "common/disjoint_sets.h"
#include "mesh/certify/boundary_surface.h"

namespace umtet::detail {
namespace {

// Of moving pinched vertices off the cut: in the bodies of the tests two rounds are enough.
constexpr int kCutRounds = 20;

std::vector<RegionSet> regions_at_vertices(const TorusMesh& torus) {
  std::vector<RegionSet> regions(torus.V.size(), 0);
  for (std::size_t t = 0; t < torus.C.size(); ++t)
    for (const Corner& c : torus.C[t]) regions[c.vertex] |= RegionSet{1} << torus.region[t];
  return regions;
}

/// Where each tet lies: its centroid is in the box whose lowest corner is `first`.
std::vector<Periods> periods_by_centroid(const TorusMesh& torus, const Vec3& first) {
  std::vector<Periods> periods;
  periods.reserve(torus.C.size());
  for (const auto& tet : torus.C) {
    Vec3 centroid = Vec3::Zero();
    for (const Corner& c : tet) centroid += torus.at(c) / 4;
    const Eigen::Array3i n = ((centroid - first).array() / torus.sides.array()).floor().cast<int>();
    periods.push_back({-n[0], -n[1], -n[2]});
  }
  return periods;
}

/// Cuts a torus open. @param periods  added to the copies of the corners of each tet
CutMesh cut_by(const TorusMesh& torus, const std::vector<Periods>& periods) {
  CutMesh cut;
  RegionMesh& made = cut.mesh;
  const std::vector<RegionSet> regions = regions_at_vertices(torus);
  std::vector<int> n_copies(torus.V.size(), 0);
  std::unordered_map<std::uint64_t, int> number;
  number.reserve(torus.V.size());
  made.mesh.C.reserve(torus.C.size());
  for (std::size_t t = 0; t < torus.C.size(); ++t) {
    Tet local{};
    for (int k = 0; k < 4; ++k) {
      Corner c = torus.C[t][k];
      auto key = static_cast<std::uint64_t>(c.vertex);
      for (int a = 0; a < 3; ++a) {
        c.copy[a] += periods[t][a];
        key = key << 8 | static_cast<std::uint8_t>(c.copy[a]);
      }
      const auto [at, is_new] = number.try_emplace(key, static_cast<int>(cut.corner.size()));
      if (is_new) {
        made.background_vertex.push_back(static_cast<std::int64_t>(cut.corner.size()));
        cut.corner.push_back(c);
        made.mesh.V.push_back(torus.at(c));
        made.regions_at.push_back(regions[c.vertex]);
        ++n_copies[c.vertex];
      }
      local[k] = at->second;
    }
    made.mesh.C.push_back(local);
    made.background_tet.push_back(static_cast<std::int64_t>(t));
  }
  made.region = torus.region;
  made.h.assign(made.mesh.V.size(), torus.h);
  for (const Corner& c : cut.corner) cut.is_on_cut.push_back(n_copies[c.vertex] > 1 ? 1 : 0);
  return cut;
}

/// Vertices at which the boundary faces do not form one fan, and one vertex of each edge without exactly two faces.
std::vector<int> pinched_vertices(const TetMesh& mesh) {
  const std::vector<Triangle> faces = boundary_faces(mesh.C, mesh.V.size()).triangles;
  std::map<std::pair<int, int>, std::vector<int>> of_edge;
  std::map<int, std::vector<int>> of_vertex;
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      of_edge[std::minmax(faces[f][k], faces[f][(k + 1) % 3])].push_back(static_cast<int>(f));
      of_vertex[faces[f][k]].push_back(static_cast<int>(f));
    }
  DisjointSets sets(3 * faces.size());  // the corners of faces
  const auto corner = [&](int f, int v) {
    const Triangle& t = faces[static_cast<std::size_t>(f)];
    return 3 * f + static_cast<int>(std::find(t.begin(), t.end(), v) - t.begin());
  };
  std::vector<int> pinched;
  for (const auto& [edge, two] : of_edge) {
    if (two.size() != 2) {
      pinched.push_back(edge.first);
      continue;
    }
    for (const int v : {edge.first, edge.second}) sets.unite(corner(two[0], v), corner(two[1], v));
  }
  for (const auto& of : of_vertex) {
    const auto fan_of = [&](int f) { return sets.find(corner(f, of.first)); };
    const std::vector<int>& around = of.second;
    if (std::any_of(around.begin(), around.end(), [&](int f) { return fan_of(f) != fan_of(around[0]); }))
      pinched.push_back(of.first);
  }
  std::sort(pinched.begin(), pinched.end());
  pinched.erase(std::unique(pinched.begin(), pinched.end()), pinched.end());
  return pinched;
}

}  // namespace

CutMesh cut_open(const TorusMesh& torus, const Vec3& first) { return cut_by(torus, periods_by_centroid(torus, first)); }

CutMesh cut_along_manifold(const TorusMesh& torus, const Vec3& first, bool& is_manifold) {
  std::vector<Periods> periods = periods_by_centroid(torus, first);
  for (int round = 0;; ++round) {
    CutMesh cut = cut_by(torus, periods);
    const std::vector<int> pinched = pinched_vertices(cut.mesh.mesh);
    is_manifold = pinched.empty();
    if (is_manifold || round == kCutRounds) return cut;
    std::vector<int> corner_of(torus.V.size(), -1);
    for (const int v : pinched) corner_of[static_cast<std::size_t>(cut.corner[static_cast<std::size_t>(v)].vertex)] = v;
    for (std::size_t t = 0; t < torus.C.size(); ++t)
      for (const Corner& c : torus.C[t]) {
        const int v = corner_of[static_cast<std::size_t>(c.vertex)];
        if (v < 0) continue;
        for (int a = 0; a < 3; ++a) periods[t][a] = cut.corner[static_cast<std::size_t>(v)].copy[a] - c.copy[a];
        break;
      }
  }
}

void close(const CutMesh& cut, TorusMesh& torus) {
  const RegionMesh& made = cut.mesh;
  const auto corner_of = [&](int v) { return cut.corner[static_cast<std::size_t>(made.background_vertex[v])]; };
  for (std::size_t v = 0; v < made.mesh.V.size(); ++v) {
    if (cut.is_on_cut[static_cast<std::size_t>(made.background_vertex[v])] != 0) continue;
    const Corner c = corner_of(static_cast<int>(v));
    torus.V[c.vertex] = made.mesh.V[v] - Vec3(c.copy[0], c.copy[1], c.copy[2]).cwiseProduct(torus.sides);
  }
  torus.C.clear();
  std::vector<std::int64_t> background_tet;
  for (std::size_t t = 0; t < made.mesh.C.size(); ++t) {
    std::array<Corner, 4> corners{};
    for (int k = 0; k < 4; ++k) corners[k] = corner_of(made.mesh.C[t][k]);
    torus.C.push_back(corners);
    const std::int64_t before = made.background_tet[t];
    background_tet.push_back(before < 0 ? -1 : torus.background_tet[static_cast<std::size_t>(before)]);
  }
  torus.background_tet = std::move(background_tet);
  torus.region = made.region;
}

}  // namespace umtet::detail
