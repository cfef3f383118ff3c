#include "mesh/regions/detail/region_fit.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

#include "mesh/core/used_vertices.h"
#include "mesh/regions/detail/region_strata.h"
#include "mesh/submesh/active_layer.h"

namespace umtet::detail {
namespace {

using Role = ActiveLayer::Role;

constexpr double kRelax = .4;  // where smoothing begins, as a share of the time

/// The layer around the interfaces, and the vertex of the mesh of each of its vertices.
struct InterfaceLayer {
  ActiveLayer layer;
  std::vector<int> vertex;
};

InterfaceLayer layer_of(const RegionMesh& made, const std::vector<char>& is_fixed, int layers) {
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
  layer.h = *std::min_element(made.h.begin(), made.h.end());
  for (std::size_t v = 0; v < n; ++v) {
    if (number[v] < 0) continue;
    number[v] = static_cast<int>(made_layer.vertex.size());
    made_layer.vertex.push_back(static_cast<int>(v));
    layer.V.push_back(made.mesh.V[v]);
    layer.local_h.push_back(made.h[v]);
    const bool stays = ring[v] >= layers || is_fixed[v] != 0;
    layer.role.push_back(stays ? Role::Fixed : ring[v] == 0 ? Role::Boundary : Role::Inner);
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

}  // namespace

void move_onto_strata(const RegionDomain& domain, const std::vector<char>& is_fixed, const RegionMeshParams& params,
                      RegionMesh& made, const Context& context) {
  InterfaceLayer part = layer_of(made, is_fixed, params.layers);
  const RegionStrata strata(domain, made);
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
}

void flip_regions(const RegionDomain& domain, const std::vector<char>& is_fixed, const LocalFlipParams& params,
                  RegionMesh& made, const Context& context) {
  const RegionStrata strata(domain, made);
  std::vector<VertexStratum> moves;
  for (std::size_t v = 0; v < made.mesh.V.size(); ++v)
    moves.push_back(is_fixed[v] != 0           ? VertexStratum::Fixed
                    : strata.of_vertex[v] >= 0 ? VertexStratum::Boundary
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

}  // namespace umtet::detail
