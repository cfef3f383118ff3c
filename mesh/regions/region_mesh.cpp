#include "mesh/regions/region_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "mesh/classification/configuration_costs.h"
#include "mesh/core/used_vertices.h"
#include "mesh/regions/detail/region_strata.h"
#include "mesh/submesh/active_layer.h"

namespace umtet {
namespace {

using Role = ActiveLayer::Role;

constexpr double kOnStratum = 1e-8;  // in h; projection leaves a thousandth of it
// Where smoothing and the flips begin, as shares of the time.
constexpr double kProject = .3, kRelax = .4, kRepair = .6;

std::vector<int> members(RegionSet set) {
  std::vector<int> list;
  for (; set != 0; set &= set - 1) list.push_back(std::countr_zero(set));
  return list;
}

/// All tets of the background, with the greatest label of their vertices.
void list_tets(const BackgroundMesh& background, const std::vector<std::uint8_t>& label, RegionMesh& made) {
  std::vector<int> number(label.size(), -1);
  const auto region_of = [&](const std::array<std::int64_t, 4>& tet) {
    std::uint8_t region = 0;
    for (const std::int64_t v : tet) region = std::max(region, label[static_cast<std::size_t>(v)]);
    return region;
  };
  const std::int64_t n = background.n_tets();
  if (n > std::numeric_limits<int>::max()) throw std::length_error("a mesh of more than 2^31 - 1 tets");
  for (std::int64_t t = 0; t < n; ++t)
    for (const std::int64_t v : background.tet(t)) number[static_cast<std::size_t>(v)] = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    number[v] = static_cast<int>(made.background_vertex.size());
    made.background_vertex.push_back(static_cast<std::int64_t>(v));
    made.mesh.V.push_back(background.position(static_cast<std::int64_t>(v)));
    made.h.push_back(background.h(static_cast<std::int64_t>(v)));
  }
  made.mesh.C.reserve(static_cast<std::size_t>(n));
  made.region.reserve(static_cast<std::size_t>(n));
  for (std::int64_t t = 0; t < n; ++t) {
    const auto tet = background.tet(t);
    Tet local{};
    for (int k = 0; k < 4; ++k) local[k] = number[static_cast<std::size_t>(tet[k])];
    made.mesh.C.push_back(local);
    made.region.push_back(region_of(tet));
    made.background_tet.push_back(t);
  }
}

void find_regions_at_vertices(RegionMesh& made) {
  made.regions_at.assign(made.mesh.V.size(), 0);
  for (std::size_t t = 0; t < made.mesh.C.size(); ++t)
    for (const int v : made.mesh.C[t]) made.regions_at[v] |= RegionSet{1} << made.region[t];
}

/// The layer around the interfaces, and the vertex of the mesh of each of its vertices.
struct InterfaceLayer {
  ActiveLayer layer;
  std::vector<int> vertex;
};

InterfaceLayer layer_of(const BackgroundMesh& background, const RegionMesh& made, int layers) {
  const std::vector<Tet>& C = made.mesh.C;
  const auto n = made.mesh.V.size();
  // Rings of tets around the interfaces: 0 at an interface vertex.
  std::vector<int> ring(n, std::numeric_limits<int>::max());
  for (std::size_t v = 0; v < n; ++v)
    if (std::popcount(made.regions_at[v]) > 1) ring[v] = 0;
  std::vector<std::size_t> near;  // tets with a vertex of the last ring
  std::vector<std::size_t> rest(C.size());
  for (std::size_t t = 0; t < C.size(); ++t) rest[t] = t;
  for (int k = 1; k <= layers; ++k) {
    std::vector<std::size_t> farther;
    std::vector<std::size_t> fresh;
    for (const std::size_t t : rest) {
      const bool is_near = std::any_of(C[t].begin(), C[t].end(), [&](int v) { return ring[v] < k; });
      (is_near ? fresh : farther).push_back(t);
    }
    for (const std::size_t t : fresh)
      for (const int v : C[t]) ring[v] = std::min(ring[v], k);
    near.insert(near.end(), fresh.begin(), fresh.end());
    rest = std::move(farther);
  }
  std::sort(near.begin(), near.end());

  InterfaceLayer made_layer;
  std::vector<int> number(n, -1);
  for (const std::size_t t : near)
    for (const int v : C[t]) number[v] = 0;
  ActiveLayer& layer = made_layer.layer;
  layer.h = background.h();
  for (std::size_t v = 0; v < n; ++v) {
    if (number[v] < 0) continue;
    number[v] = static_cast<int>(made_layer.vertex.size());
    made_layer.vertex.push_back(static_cast<int>(v));
    layer.V.push_back(made.mesh.V[v]);
    layer.local_h.push_back(made.h[v]);
    const bool is_fixed = ring[v] >= layers || background.on_boundary(made.background_vertex[v]);
    layer.role.push_back(is_fixed ? Role::Fixed : ring[v] == 0 ? Role::Boundary : Role::Inner);
  }
  for (const std::size_t t : near) {
    Tet local{};
    for (int k = 0; k < 4; ++k) local[k] = number[C[t][k]];
    layer.C.push_back(local);
  }
  list_rings(layer);
  colour_greedily(layer);
  return made_layer;
}

/// Flips, and the numbers of the vertices that are left.
void flip(const RegionDomain& domain, const detail::RegionStrata& strata, const LocalFlipParams& params,
          RegionMesh& made, const Context& context) {
  std::vector<VertexStratum> moves;
  for (std::size_t v = 0; v < made.mesh.V.size(); ++v)
    moves.push_back(strata.of_vertex[v] >= 0 ? VertexStratum::Boundary
                    : strata.is_fixed[v]     ? VertexStratum::Fixed
                                             : VertexStratum::Inner);
  const StratifiedVertices vertices{&strata.strata, strata.of_vertex,
                                    [&domain](int a, int b) { return domain.patch(a, b); }};
  FlippedMesh flipped =
      flip_locally(std::move(made.mesh.V), std::move(made.mesh.C), moves, ImplicitFunctionRef(domain.boundary()),
                   params, made.flips, context, &vertices, std::move(made.region));
  const UsedVertices used(flipped.C, flipped.V.size());
  used.keep(flipped.V);
  used.keep(made.background_vertex);
  used.keep(made.h);
  for (Tet& t : flipped.C) used.renumber(t);
  std::vector<std::int64_t> background_tet;
  background_tet.reserve(flipped.origin.size());
  for (const std::int64_t t : flipped.origin)
    background_tet.push_back(t < 0 ? -1 : made.background_tet[static_cast<std::size_t>(t)]);
  made.background_tet = std::move(background_tet);
  made.mesh.V = std::move(flipped.V);
  made.mesh.C = std::move(flipped.C);
  made.region = std::move(flipped.region);
}

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

/// Removes the tets of region 0.
void drop_outside(RegionMesh& made) {
  std::vector<int> new_tet(made.mesh.C.size(), -1), new_vertex(made.mesh.V.size(), -1);
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

}  // namespace

RegionMesh make_region_mesh(const RegionDomain& domain, const BackgroundMesh& background,
                            const RegionMeshParams& params, const Context& context) {
  if (params.layers < 1) throw std::invalid_argument("layers must be >= 1");
  RegionMesh made;
  context.report("search", 0);
  const auto costs = background_costs(background);
  if (!costs) throw std::invalid_argument("regions need a background whose links fit into masks");
  made.labels = choose_labels(domain, background, *costs->links, params.labels, context);
  if (made.labels.leaves_background) {
    made.status = UmStatus::DomainLeavesBackground;
    made.evidence.what = "a region reaches the boundary of the background mesh";
    return made;
  }
  if (made.labels.n_interface == 0) {
    made.status = UmStatus::EmptyDomain;
    made.evidence.what = "no vertex of the background is in a region";
    return made;
  }
  list_tets(background, made.labels.of_vertex, made);
  made.labels.of_vertex = {};
  find_regions_at_vertices(made);
  for (const InvalidVertex& v : made.labels.invalid)
    made.defects.push_back(
        {RegionDefect::Kind::Connectivity, background.position(v.background_vertex), members(v.regions)});

  context.report("project", kProject);
  InterfaceLayer part = layer_of(background, made, params.layers);
  const detail::RegionStrata strata(domain, background, made);
  ActiveLayer& layer = part.layer;
  layer.strata = &strata.strata;
  const std::vector<Vec3> targets = strata.targets(made);
  std::vector<Vec3> target;
  for (const int v : part.vertex) {
    layer.stratum.push_back(strata.of_vertex[v]);
    target.push_back(targets[v]);
  }
  PNormSmoother smoother(layer);
  const ImplicitFunctionRef psi(domain.boundary());
  project_onto_strata(smoother, psi, target, params.projection, context);
  context.report("relax", kRelax);
  smoother.enqueue_all();
  smoother.run(psi, params.smoothing, context);
  for (std::size_t v = 0; v < part.vertex.size(); ++v) made.mesh.V[part.vertex[v]] = layer.V[v];
  context.report("repair", kRepair);
  flip(domain, strata, params.flips, made, context);
  find_regions_at_vertices(made);
  const detail::RegionStrata after(domain, background, made);
  for (std::size_t v = 0; v < made.mesh.V.size(); ++v)
    if (after.of_vertex[v] >= 0 &&
        !(after.strata.distance(after.of_vertex[v], made.mesh.V[v]) <= kOnStratum * made.h[v]))
      made.defects.push_back({RegionDefect::Kind::NotOnStratum, made.mesh.V[v], members(made.regions_at[v])});
  list_lost_regions(domain.n_regions(), made);
  list_faces(made);
  if (!params.has_outside) drop_outside(made);
  return made;
}

}  // namespace umtet
