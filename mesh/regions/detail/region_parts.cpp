#include "mesh/regions/detail/region_parts.h"

#include <algorithm>
#include <bit>
#include <map>
#include <numeric>
#include <utility>

#include "mesh/core/tet_quality.h"
#include "mesh/regions/detail/region_strata.h"

namespace umtet::detail {
namespace {

constexpr double kOnStratum = 1e-8;  // in h; projection leaves a thousandth of it

/// Lists the faces between regions.
void list_faces(RegionMesh& made) {
  struct Face {
    Triangle key, face;
    int tet;
  };
  const std::vector<Tet>& C = made.mesh.C;
  std::vector<Face> faces;
  for (std::size_t t = 0; t < C.size(); ++t) {
    for (const auto& f : kTetFace) {
      const Triangle face = {C[t][f[0]], C[t][f[1]], C[t][f[2]]};
      const bool is_candidate =
          std::all_of(face.begin(), face.end(), [&](int v) { return std::popcount(made.regions_at[v]) > 1; });
      if (!is_candidate) continue;
      Triangle key = face;
      std::sort(key.begin(), key.end());
      faces.push_back({key, face, static_cast<int>(t)});
    }
  }
  std::sort(faces.begin(), faces.end(),
            [](const Face& a, const Face& b) { return std::pair(a.key, a.tet) < std::pair(b.key, b.tet); });
  for (std::size_t k = 0; k + 1 < faces.size(); ++k) {
    if (faces[k].key != faces[k + 1].key) continue;
    const Face &a = faces[k], &b = faces[k + 1];
    const int ra = made.region[a.tet], rb = made.region[b.tet];
    if (ra == rb) continue;
    made.interfaces.push_back(ra > rb ? InterfaceFace{a.face, ra, rb, a.tet, b.tet}
                                      : InterfaceFace{b.face, rb, ra, b.tet, a.tet});
  }
  std::sort(made.interfaces.begin(), made.interfaces.end(), [](const InterfaceFace& a, const InterfaceFace& b) {
    return std::pair(a.tet, a.face) < std::pair(b.tet, b.face);
  });
}

/// Removes the tets of region 0. @param new_vertex  receives the new number of each vertex, or -1
void drop_outside(RegionMesh& made, std::vector<int>& new_vertex) {
  std::vector<int> new_tet(made.mesh.C.size(), -1);
  new_vertex.assign(made.mesh.V.size(), -1);
  std::size_t n = 0;
  for (std::size_t t = 0; t < made.mesh.C.size(); ++t) {
    if (made.region[t] == 0) continue;
    for (const int v : made.mesh.C[t]) new_vertex[v] = 0;
    new_tet[t] = static_cast<int>(n);
    made.mesh.C[n] = made.mesh.C[t];
    made.region[n] = made.region[t];
    made.background_tet[n] = made.background_tet[t];
    ++n;
  }
  made.mesh.C.resize(n);
  made.region.resize(n);
  made.background_tet.resize(n);
  int m = 0;
  for (std::size_t v = 0; v < new_vertex.size(); ++v) {
    if (new_vertex[v] < 0) continue;
    new_vertex[v] = m;
    made.mesh.V[m] = made.mesh.V[v];
    made.background_vertex[m] = made.background_vertex[v];
    made.h[m] = made.h[v];
    made.regions_at[m] = made.regions_at[v];
    ++m;
  }
  made.mesh.V.resize(m);
  made.background_vertex.resize(m);
  made.h.resize(m);
  made.regions_at.resize(m);
  for (Tet& t : made.mesh.C)
    for (int& v : t) v = new_vertex[v];
  for (InterfaceFace& f : made.interfaces) {
    for (int& v : f.face) v = new_vertex[v];
    f.tet = new_tet[f.tet];
    f.other_tet = new_tet[f.other_tet];
  }
}

void list_lost_regions(int n_regions, RegionMesh& made) {
  std::vector<char> has_tet(static_cast<std::size_t>(n_regions), 0);
  for (const int r : made.region) has_tet[r] = 1;
  for (int r = 1; r < n_regions; ++r)
    if (!has_tet[r]) made.defects.push_back({RegionDefect::Kind::Lost, Vec3::Zero(), {r}});
}

/// Lists the vertices that were not valid and have a tet below a mean ratio: flips have mended the others.
void list_poor_connectivity(double poor, const std::function<Vec3(std::int64_t)>& position, RegionMesh& made) {
  std::map<std::int64_t, double> least;
  for (const InvalidVertex& v : made.labels.invalid) least[v.background_vertex] = 1;
  if (least.empty()) return;
  for (const Tet& t : made.mesh.C)
    for (const int v : t)
      if (const auto at = least.find(made.background_vertex[v]); at != least.end())
        at->second = std::min(at->second, mean_ratio(made.mesh, t));
  for (const InvalidVertex& v : made.labels.invalid)
    if (least[v.background_vertex] < poor)
      made.defects.push_back({RegionDefect::Kind::Connectivity, position(v.background_vertex), members(v.regions)});
}

void list_vertices_off(const RegionDomain& domain, RegionMesh& made) {
  const RegionStrata strata(domain, made);
  for (std::size_t v = 0; v < made.mesh.V.size(); ++v)
    if (strata.of_vertex[v] >= 0 &&
        !(strata.strata.distance(strata.of_vertex[v], made.mesh.V[v]) <= kOnStratum * made.h[v]))
      made.defects.push_back({RegionDefect::Kind::NotOnStratum, made.mesh.V[v], members(made.regions_at[v])});
}

}  // namespace

std::vector<int> members(RegionSet set) {
  std::vector<int> list;
  for (; set != 0; set &= set - 1) list.push_back(std::countr_zero(set));
  return list;
}

void find_regions_at_vertices(RegionMesh& made) {
  made.regions_at.assign(made.mesh.V.size(), 0);
  for (std::size_t t = 0; t < made.mesh.C.size(); ++t)
    for (const int v : made.mesh.C[t]) made.regions_at[v] |= RegionSet{1} << made.region[t];
}

std::vector<int> finish(const RegionDomain& domain, const RegionMeshParams& params,
                        const std::function<Vec3(std::int64_t)>& position, RegionMesh& made) {
  list_poor_connectivity(params.labels.poor_quality, position, made);
  list_vertices_off(domain, made);
  list_lost_regions(domain.n_regions(), made);
  list_faces(made);
  std::vector<int> new_vertex(made.mesh.V.size());
  std::iota(new_vertex.begin(), new_vertex.end(), 0);
  if (!params.has_outside) drop_outside(made, new_vertex);
  return new_vertex;
}

}  // namespace umtet::detail
