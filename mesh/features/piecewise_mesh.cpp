#include "mesh/features/piecewise_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>

#include "mesh/classification/configuration_costs.h"
#include "mesh/core/boundary_strata.h"
#include "mesh/core/used_vertices.h"
#include "mesh/fast/fast_mesh.h"
#include "mesh/submesh/linked_active_layer.h"

namespace umtet {
namespace {

constexpr double kOnStratum = 1e-8;  // in h; projection leaves a thousandth of it
// Degrees. At a sharper edge a single tet fills the wedge over a long way: with edges up to 2.3 instead of 3.2 lengths
// the least Q of a wedge of 30 degrees is .50 instead of .74.
constexpr double kSharpAngle = 40, kLongestAtSharp = 3.2;
// Rounds in which a vertex that has no foot on its patch goes between its neighbours.
constexpr int kAverages = 8;
// Where smoothing and the flips begin, as shares of the time.
constexpr double kRelax = .5, kRepair = .6;

/// Targets for vertices of patches whose feet are beyond the curves around: between the targets of their neighbours.
void place_between_neighbours(const std::vector<Triangle>& faces, const FeatureEmbedding& embedded,
                              const BoundaryStrata& strata, const std::vector<Vec3>& V, const std::vector<double>& h,
                              std::vector<Vec3>& target) {
  std::vector<std::vector<int>> neighbours(V.size());
  for (const Triangle& f : faces)
    for (int k = 0; k < 3; ++k) neighbours[f[k]].push_back(f[(k + 1) % 3]);  // every edge has two faces, one each way
  std::vector<int> lost;
  std::vector<Vec3> place = target;
  for (std::size_t v = 0; v < V.size(); ++v) {
    if (embedded.stratum[v] < 0 || target[v].allFinite()) continue;
    if (strata.foot(embedded.stratum[v], V[v], h[v], place[v])) continue;
    place[v] = V[v];
    lost.push_back(static_cast<int>(v));
  }
  std::vector<std::uint8_t> is_found(V.size(), 0);
  for (int round = 0; round < kAverages; ++round) {
    for (const int v : lost) {
      Vec3 sum = Vec3::Zero();
      int n = 0;
      for (const int w : neighbours[v]) {
        if (!strata.is_in_closure(embedded.stratum[w], embedded.stratum[v]) || !place[w].allFinite()) continue;
        sum += place[w];
        ++n;
      }
      Vec3 foot;
      if (n == 0 || !strata.foot(embedded.stratum[v], sum / n, h[v], foot)) continue;
      place[v] = foot;
      is_found[v] = 1;
    }
  }
  for (const int v : lost)
    if (is_found[v]) target[v] = place[v];
}

/// The layer's strata and the points that its vertices go to.
std::vector<Vec3> set_strata(const FeatureGraph& graph, const FeatureEmbedding& embedded, const BoundaryStrata& strata,
                             const Submesh& submesh, const std::vector<double>& h, const std::vector<int>& of_layer,
                             ActiveLayer& layer) {
  const std::vector<Vec3>& V = submesh.mesh.V;
  std::vector<Vec3> target(V.size(), Vec3::Constant(std::numeric_limits<double>::quiet_NaN()));
  for (std::size_t c = 0; c < embedded.chains.size(); ++c) {
    const std::vector<int>& chain = embedded.chains[c];
    for (std::size_t k = 0; k < chain.size(); ++k) {
      const Vec3 on_polyline = graph.curves[c].at(embedded.chain_arc[c][k]);
      Vec3 place;
      if (strata.foot(embedded.stratum[chain[k]], on_polyline, h[chain[k]], place)) target[chain[k]] = place;
    }
  }
  for (std::size_t c = 0; c < embedded.corner_vertex.size(); ++c)
    if (const int v = embedded.corner_vertex[c]; v >= 0) target[v] = graph.corners[c].place;
  place_between_neighbours(submesh.positive_faces, embedded, strata, V, h, target);

  layer.strata = &strata;
  std::vector<Vec3> of_vertices;
  for (const int v : of_layer) {
    layer.stratum.push_back(embedded.stratum[v]);
    of_vertices.push_back(target[v]);
  }
  return of_vertices;
}

/// Lists the faces of exactly one tet, outward, in the order of their tets.
void list_boundary(const std::vector<int>& stratum, PiecewiseMesh& made) {
  const std::vector<Tet>& C = made.mesh.C;
  struct Face {
    Triangle key, face;
    std::size_t tet;
  };
  std::vector<Face> all;
  for (std::size_t t = 0; t < C.size(); ++t) {
    for (const auto& f : kTetFace) {
      const Triangle face = {C[t][f[0]], C[t][f[1]], C[t][f[2]]};
      if (std::any_of(face.begin(), face.end(), [&](int v) { return stratum[v] < 0; })) continue;
      Triangle key = face;
      std::sort(key.begin(), key.end());
      all.push_back({key, face, t});
    }
  }
  std::sort(all.begin(), all.end(),
            [](const Face& a, const Face& b) { return std::pair(a.key, a.tet) < std::pair(b.key, b.tet); });
  std::vector<Face> alone;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const bool is_twin =
        (k > 0 && all[k - 1].key == all[k].key) || (k + 1 < all.size() && all[k + 1].key == all[k].key);
    if (!is_twin) alone.push_back(all[k]);
  }
  std::stable_sort(alone.begin(), alone.end(), [](const Face& a, const Face& b) { return a.tet < b.tet; });
  made.faces.clear();
  made.face_tet.clear();
  for (const Face& f : alone) {
    made.faces.push_back(f.face);
    made.face_tet.push_back(static_cast<int>(f.tet));
  }
}

/// The patch of a face: the one that the strata of its corners have in common, or, of several such patches, the active
/// one at its middle. -1: there is none.
int patch_of(const PiecewiseDomain& domain, const BoundaryStrata& strata, const PiecewiseMesh& made,
             const Triangle& face) {
  const std::array<int, 3> s = {made.stratum[face[0]], made.stratum[face[1]], made.stratum[face[2]]};
  const int only = strata.patch_of(s[0], s[1], s[2]);
  if (only >= -1) return only;
  const std::vector<Vec3>& V = made.mesh.V;
  const int active = domain.active((V[face[0]] + V[face[1]] + V[face[2]]) / 3);
  const bool is_common = std::all_of(s.begin(), s.end(), [&](int k) {
    const std::vector<int>& patches = made.strata[k].patches;
    return std::binary_search(patches.begin(), patches.end(), active);
  });
  return is_common ? active : -1;
}

/// Flips, and the numbers of the vertices that are left.
void flip(const PiecewiseDomain& domain, ImplicitFunctionRef psi, const BoundaryStrata& strata,
          const LocalFlipParams& params, PiecewiseMesh& made, const Context& context) {
  std::vector<VertexStratum> moves;
  for (const int s : made.stratum) moves.push_back(s < 0 ? VertexStratum::Inner : VertexStratum::Boundary);
  const StratifiedVertices vertices{&strata, made.stratum};
  FlippedMesh flipped =
      flip_locally(std::move(made.mesh.V), std::move(made.mesh.C), moves, psi, params, made.flips, context, &vertices);
  const UsedVertices used(flipped.C, flipped.V.size());
  used.keep(flipped.V);
  used.keep(made.background_vertex);
  used.keep(made.h);
  used.keep(made.stratum);
  for (Tet& t : flipped.C) used.renumber(t);
  for (std::vector<int>& chain : made.chains) {
    const bool is_closed = chain.size() > 1 && chain.front() == chain.back();
    if (is_closed) chain.pop_back();
    std::erase_if(chain, [&](int v) { return used[v] < 0; });
    used.renumber(chain);
    if (is_closed && !chain.empty()) chain.push_back(chain.front());
  }
  for (int& v : made.corner_vertex)
    if (v >= 0) v = used[v];
  made.mesh.V = std::move(flipped.V);
  made.mesh.C = std::move(flipped.C);
  made.tet_of_chosen = std::move(flipped.origin);
  list_boundary(made.stratum, made);
  made.face_patch.clear();
  for (const Triangle& f : made.faces) made.face_patch.push_back(patch_of(domain, strata, made, f));
}

/// Names the vertices that are not on their corner, curve or patch.
void list_off_strata(const BoundaryStrata& strata, PiecewiseMesh& made) {
  for (std::size_t v = 0; v < made.mesh.V.size(); ++v) {
    if (made.stratum[v] < 0) continue;
    const Vec3& x = made.mesh.V[v];
    if (!(strata.distance(made.stratum[v], x) <= kOnStratum * made.h[v]))
      made.defects.push_back({FeatureDefect::Kind::NotOnStratum, -1, -1, x});
  }
}

}  // namespace

PiecewiseMeshParams::PiecewiseMeshParams() {
  // The farthest shift that classification accepts: with .1 the least Q of a wedge of 45 degrees is .71 instead of .78.
  classification.shift = .15;
  // Edges of 90 degrees and less are left with one tet only if its neighbours may be long: with edges up to 1.6 instead
  // of 2.3 lengths the least Q of a cube is .68 instead of .80. The lower promise raises a wedge of 60 degrees. All
  // tets below the target mended, and 20 failures, take 2.5 times the time on joint.obj and eight times on a plate as
  // thick as an edge, for a least Q that is .02 higher on a cube (`umtet run cube.obj`).
  local_flips = {.target = .81,
                 .mend_below = .785,
                 .mend_below_at_last = .785,
                 .shortest = .45,
                 .longest = 2.3,
                 .most_candidates = 6,
                 .promising = .45,
                 .promising_at_last = .3};
}

PiecewiseMesh make_piecewise_mesh(const PiecewiseDomain& domain, const BackgroundMesh& background,
                                  const PiecewiseMeshParams& params, const Context& context,
                                  const FeatureGraph* graph) {
  FastParams fast;
  fast.classification = params.classification;
  ChosenSubmesh chosen = classified_submesh(background, ImplicitFunctionRef(domain), params.submesh, fast, context);
  return fit_piecewise_mesh(domain, background, std::move(chosen), graph, params, context);
}

PiecewiseMesh fit_piecewise_mesh(const PiecewiseDomain& domain, const BackgroundMesh& background, ChosenSubmesh chosen,
                                 const FeatureGraph* graph, const PiecewiseMeshParams& params, const Context& context) {
  PiecewiseMesh made;
  const ImplicitFunctionRef psi(domain);
  made.status = chosen.status;
  made.evidence = chosen.evidence;
  if (chosen.status != UmStatus::Success) return made;
  Submesh submesh = chosen.is_whole ? std::move(chosen.submesh) : emit_submesh(background, chosen.inside);
  for (const std::int64_t v : submesh.background_vertex) made.h.push_back(background.h(v));

  context.report("project", 0);
  if (graph) {
    made.graph = *graph;
  } else {
    std::vector<Vec3> seeds;
    for (const int v : submesh.positive_vertices) seeds.push_back(submesh.mesh.V[v]);
    made.graph = trace_features(domain, seeds, background.h(), context);
  }
  FeatureEmbedding embedded =
      embed_features(domain, made.graph, submesh.mesh.V, submesh.mesh.C, submesh.positive_faces, made.h, context);
  made.defects = made.graph.defects;
  made.defects.insert(made.defects.end(), embedded.defects.begin(), embedded.defects.end());
  const BoundaryStrata strata(domain, embedded.strata);

  BackgroundLayer part = linked_active_layer(background, *chosen.links, chosen.inside, params.layers);
  std::vector<int> of_layer;
  for (const std::int64_t id : part.background_vertex) {
    const auto at = std::lower_bound(submesh.background_vertex.begin(), submesh.background_vertex.end(), id);
    of_layer.push_back(static_cast<int>(at - submesh.background_vertex.begin()));
  }
  const std::vector<Vec3> target = set_strata(made.graph, embedded, strata, submesh, made.h, of_layer, part.layer);
  PNormSmoother smoother(part.layer);
  const auto with_layer = [&] {
    std::vector<Vec3> V = submesh.mesh.V;
    for (std::size_t v = 0; v < of_layer.size(); ++v) V[of_layer[v]] = part.layer.V[v];
    return V;
  };
  project_onto_strata(smoother, psi, target, params.projection, context);
  made.projected = with_layer();
  for (int v = 0; v < static_cast<int>(part.layer.V.size()); ++v)
    part.layer.ball.push_back(part.layer.role[v] == ActiveLayer::Role::Boundary
                                  ? strata.ball_on_patch(part.layer.stratum[v], part.layer.V[v], part.layer.h_at(v))
                                  : BallOnPatch{});
  context.report("relax", kRelax);
  smoother.enqueue_all();
  smoother.run(psi, params.smoothing, context);
  made.smoothed = with_layer();
  made.mesh.V = made.smoothed;
  made.mesh.C = submesh.mesh.C;
  made.background_vertex = submesh.background_vertex;
  made.tet_of_chosen.resize(made.mesh.C.size());
  std::iota(made.tet_of_chosen.begin(), made.tet_of_chosen.end(), std::int64_t{0});
  made.faces = submesh.positive_faces;
  made.face_tet = submesh.positive_tets;
  made.chosen = std::move(submesh);
  made.face_patch = std::move(embedded.face_patch);
  made.strata = std::move(embedded.strata);
  made.stratum = std::move(embedded.stratum);
  made.corner_vertex = std::move(embedded.corner_vertex);
  made.chains = std::move(embedded.chains);
  LocalFlipParams local_flips = params.local_flips;
  for (const FeatureCurve& c : made.graph.curves)
    if (*std::min_element(c.angle_deg.begin(), c.angle_deg.end()) < kSharpAngle)
      local_flips.longest = std::max(local_flips.longest, kLongestAtSharp);
  context.report("repair", kRepair);
  if (params.flips) flip(domain, psi, strata, local_flips, made, context);
  list_off_strata(strata, made);
  return made;
}

}  // namespace umtet
