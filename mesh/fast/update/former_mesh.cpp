#include "mesh/fast/update/former_mesh.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <utility>

#include "common/polled_loops.h"
#include "mesh/base/id_blocks.h"
#include "mesh/core/asking_psi.h"
#include "mesh/fast/update/detail/flat_tets.h"
#include "mesh/submesh/assemble_submesh.h"

namespace umtet {
namespace {

// Vertices within this many edges of one that is not kept may move: two layers, as behind any boundary, and one for the
// tets between these and what stays.
constexpr int kLooseRings = 3;
constexpr std::size_t kVerticesPerTask = 1 << 12;  // of some hundred nanoseconds each

/// f(v) for all ids, by threads of whole words of a set.
template <class F>
void for_each_vertex(const BackgroundMesh& background, const F& f) {
  static_assert(kVerticesPerTask % 64 == 0);
  const auto n = static_cast<std::size_t>(background.n_vertices());
  tbb::parallel_for(std::size_t{0}, (n + kVerticesPerTask - 1) / kVerticesPerTask, [&](std::size_t task) {
    const std::size_t end = std::min(n, (task + 1) * kVerticesPerTask);
    for (std::size_t v = task * kVerticesPerTask; v < end; ++v) f(static_cast<std::int64_t>(v));
  });
}

/// Local vertices of a mesh by background id, or -1.
int local_vertex(const Submesh& omega_h, std::int64_t id) {
  const auto& ids = omega_h.background_vertex;
  const auto at = std::lower_bound(ids.begin(), ids.end(), id);
  return at != ids.end() && *at == id ? static_cast<int>(at - ids.begin()) : -1;
}

IdSet inside_of(const FormerMesh& former) {
  IdSet inside(former.background.n_vertices());
  for (const std::int64_t v : former.mesh.submesh.background_vertex) inside.insert(v);
  for (const int i : former.mesh.submesh.positive_vertices) inside.erase(former.mesh.submesh.background_vertex[i]);
  return inside;
}

/// Whether a vertex and one of its neighbours are on two sides.
bool is_cut(const VertexLinks& links, const IdSet& inside, std::int64_t v) {
  const LinkMask m = links.mask(v, inside);
  return inside.test(v) ? m != links.at(v).full() : m != 0;
}

/// The former id of a vertex at the same place, or -1.
std::int64_t former_id(const BackgroundMesh& background, const BackgroundMesh& former, std::int64_t v) {
  const std::int64_t id = former.vertex_of_key(background.key_of_vertex(v));
  return id >= 0 && former.position(id) == background.position(v) ? id : -1;
}

}  // namespace

FormerStates former_states(const BackgroundMesh& background, const VertexLinks& links, ImplicitFunctionRef psi,
                           const FormerMesh& former, const Context& context) {
  const std::int64_t n = background.n_vertices();
  FormerStates states{.inside = IdSet(n), .same = IdSet(n), .cut = {}};
  const IdSet former_inside = inside_of(former);
  IdSet known(n);
  for_each_vertex(background, [&](std::int64_t v) {
    const std::int64_t id = former_id(background, former.background, v);
    if (id < 0) return;
    known.insert_shared(v);
    if (former_inside.test(id)) states.inside.insert_shared(v);
  });
  context.poll();
  // A leaf that is divided puts vertices into all stars that it changes.
  for_each_in_blocks(known, [&](std::size_t, std::int64_t v) {
    bool same = true;
    links.for_each(v, [&](std::int64_t w) { same &= known.test(w); });
    if (same) states.same.insert_shared(v);
  });
  std::vector<std::int64_t> fresh;
  for (std::int64_t v = 0; v < n; ++v) {
    if (!states.same.test(v)) fresh.push_back(v);
  }
  PsiValues values(fresh.size());
  for_each_asking(psi, fresh.size(), kValuesPerPoll, context, [&](std::size_t k) {
    values[k].vertex = fresh[k];
    values[k].value = psi.value(background.position(fresh[k]), values[k].gradient);
  });
  states.psi_evaluations = fresh.size();
  IdSet of_seeds(0);
  if (!former.seeds.empty()) {
    CrawledVertices crawled = crawl_inside(background, psi, former.seeds, context);
    of_seeds = std::move(crawled.inside);
    states.psi_evaluations += crawled.n_psi_evaluations;
  }
  for (const PsiValue& at : values) {
    const bool is_inside = former.seeds.empty() ? at.value < 0 : of_seeds.test(at.vertex);
    is_inside ? states.inside.insert(at.vertex) : states.inside.erase(at.vertex);
  }
  std::erase_if(values, [&](const PsiValue& at) { return !is_cut(links, states.inside, at.vertex); });
  states.cut = std::move(values);
  return states;
}

std::vector<KeptVertex> kept_vertices(const BackgroundMesh& background, const VertexLinks& links,
                                      const FormerMesh& former, const FormerStates& states, const IdSet& inside) {
  const auto is_as_before = [&](std::int64_t v) { return inside.test(v) == states.inside.test(v); };
  std::vector<KeptVertex> kept;
  states.same.for_each([&](std::int64_t v) {
    if (!is_as_before(v) || (!inside.test(v) && links.mask(v, inside) == 0)) return;
    bool stays = true;
    links.for_each(v, [&](std::int64_t w) { stays &= is_as_before(w); });
    if (stays) kept.push_back({v, Vec3::Zero(), Vec3::Zero()});
  });
  const Submesh& omega_h = former.mesh.submesh;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, kept.size(), kVerticesPerTask), [&](const auto& range) {
    for (std::size_t k = range.begin(); k != range.end(); ++k) {
      const std::int64_t id = former.background.vertex_of_key(background.key_of_vertex(kept[k].vertex));
      const int local = local_vertex(omega_h, id);
      if (local < 0) {
        kept[k].vertex = -1;  // it was at a place that omega_h has lost
        continue;
      }
      kept[k].projected = former.mesh.projected[static_cast<std::size_t>(local)];
      kept[k].final = former.mesh.final[static_cast<std::size_t>(local)];
    }
  });
  std::erase_if(kept, [](const KeptVertex& k) { return k.vertex < 0; });
  return kept;
}

IdSet loose_vertices(const BackgroundMesh& background, const VertexLinks& links, const IdSet& inside,
                     const std::vector<KeptVertex>& kept) {
  IdSet loose(background.n_vertices()), is_kept(background.n_vertices());
  for (const KeptVertex& k : kept) is_kept.insert(k.vertex);
  for_each_vertex(background, [&](std::int64_t v) {
    if (!is_kept.test(v) && (inside.test(v) || links.mask(v, inside) != 0)) loose.insert_shared(v);
  });
  IdSet front = loose;
  for (int ring = 0; ring < kLooseRings; ++ring) {
    IdSet next(background.n_vertices());
    for_each_in_blocks(front, [&](std::size_t, std::int64_t v) {
      links.for_each(v, [&](std::int64_t w) {
        if (!loose.test(w)) next.insert_shared(w);
      });
    });
    for (std::size_t w = 0; w < next.n_words(); ++w) loose.set_word(w, loose.word(w) | next.word(w));
    front = std::move(next);
  }
  return loose;
}

void begin_where_kept(const std::vector<KeptVertex>& kept, const ProjectionParams& projection, BackgroundLayer& layer) {
  std::vector<Vec3>& V = layer.layer.V;
  const std::vector<Vec3> background_V = V;
  std::vector<std::uint8_t> moves(V.size());
  auto k = kept.begin();
  for (std::size_t v = 0; v < V.size(); ++v) {
    while (k != kept.end() && k->vertex < layer.background_vertex[v]) ++k;
    if (k == kept.end() || k->vertex != layer.background_vertex[v]) continue;
    V[v] = k->final;
    moves[v] = layer.layer.role[v] != ActiveLayer::Role::Fixed ? 1 : 0;
  }
  const auto has_left = [&](int v) { return moves[v] != 0 && V[v] != background_V[v]; };
  detail::go_back_where_flat(layer.layer, projection.least_quality, has_left, [&](int v) {
    if (has_left(v)) V[v] = background_V[v];
  });
}

}  // namespace umtet
