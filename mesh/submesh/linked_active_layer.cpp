#include "mesh/submesh/linked_active_layer.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "common/first_touch.h"
#include "mesh/base/id_blocks.h"
#include "mesh/base/id_list.h"

namespace umtet {
namespace {

constexpr std::size_t kVerticesPerTask = 1 << 14;  // a nanosecond each

class Builder {
 public:
  Builder(const BackgroundMesh& background, const VertexLinks& links, const IdSet& inside)
      : background_(background), links_(links), inside_(inside) {}

  LinkMask mask(std::int64_t v) const { return links_.mask(v, inside_); }
  /// A vertex of omega_h, if v is an id at all.
  bool in_omega_h(std::int64_t v) const { return inside_.test_any(v) || mask(v) != 0; }

  /// @param own  of the movable ones those that move here
  BackgroundLayer build(const IdSet& movable, const IdSet& own) const;
  /// @param movable  ascending
  BackgroundLayer build(const IdList& movable) const;

 private:
  std::vector<int> type_colours() const;
  void set_sizes_and_colours(BackgroundLayer& made) const;
  template <class Movable, class F>
  void tets_at(std::int64_t v, const Movable& movable, const F& f) const;
  template <class F>
  void ring_vertices(std::int64_t v, const F& f) const;
  template <class Movable>
  ActiveLayer::Role role(std::int64_t v, const Movable& movable) const;

  const BackgroundMesh& background_;
  const VertexLinks& links_;
  const IdSet& inside_;
};

std::vector<int> Builder::type_colours() const {
  std::vector<int> colour(background_.n_types(), -1);
  for (int type = 0; type < background_.n_types(); ++type) {
    std::uint64_t taken = 0;
    for (const Tiling::Corner& c : background_.tiling_tables().link[type]) {
      if (c.type == type) throw std::invalid_argument("tiling: a vertex type that is its own neighbour");
      if (colour[c.type] >= 0) taken |= std::uint64_t{1} << colour[c.type];
    }
    colour[type] = std::countr_one(taken);
  }
  return colour;
}

/// f(v, a, b, c) for the tets of omega_h at v that have no movable vertex below it.
template <class Movable, class F>
void Builder::tets_at(std::int64_t v, const Movable& movable, const F& f) const {
  const LinkTopology& link = links_.at(v);
  const LinkMask in = inside_.test(v) ? ~LinkMask{0} : mask(v);
  LinkMask lower = 0;
  std::array<std::int64_t, kMaxLink> ring;
  int k = 0;
  links_.for_each(v, [&](std::int64_t w) {
    lower |= static_cast<LinkMask>(w < v && movable.test_any(w)) << k;
    ring[k++] = w;
  });
  for (const auto& t : link.triangles) {
    const LinkMask corners = LinkMask{1} << t[0] | LinkMask{1} << t[1] | LinkMask{1} << t[2];
    if ((in & corners) != 0 && (lower & corners) == 0) f(v, ring[t[0]], ring[t[1]], ring[t[2]]);
  }
}

/// f(w) for v and the vertices of its tets in omega_h.
template <class F>
void Builder::ring_vertices(std::int64_t v, const F& f) const {
  f(v);
  const LinkTopology& link = links_.at(v);
  LinkMask near = link.full();
  if (!inside_.test(v)) {
    // The ring of an outside vertex is that of its link triangles with an inside vertex.
    const LinkMask in = near = mask(v);
    for (const auto& t : link.triangles) {
      const LinkMask corners = LinkMask{1} << t[0] | LinkMask{1} << t[1] | LinkMask{1} << t[2];
      if ((in & corners) != 0) near |= corners;
    }
  }
  for (; near != 0; near &= near - 1) f(links_.neighbour(v, std::countr_zero(near)));
}

template <class Movable>
ActiveLayer::Role Builder::role(std::int64_t v, const Movable& movable) const {
  if (!movable.test(v)) return ActiveLayer::Role::Fixed;
  const bool positive = !inside_.test(v) && links_.at(v).state(mask(v)).n_positive_faces > 0;
  return positive ? ActiveLayer::Role::Boundary : ActiveLayer::Role::Inner;
}

BackgroundLayer Builder::build(const IdSet& movable, const IdSet& own) const {
  IdSet used(background_.n_vertices());
  std::vector<std::size_t> begin(n_blocks(movable) + 1, 0);  // of the tets
  const bool all_own = &own == &movable;
  const auto has_own = [&](auto... corners) { return all_own || (own.test_any(corners) || ...); };
  for_each_in_blocks(
      own, [&](std::size_t, std::int64_t v) { ring_vertices(v, [&](std::int64_t w) { used.insert_shared(w); }); });
  for_each_in_blocks(movable, [&](std::size_t b, std::int64_t v) {
    tets_at(v, movable, [&](auto... corners) { begin[b + 1] += has_own(corners...); });
  });
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  const std::size_t n_vertices = used.index();

  BackgroundLayer result;
  ActiveLayer& layer = result.layer;
  layer.h = background_.h();
  result.background_vertex = touched<std::int64_t>(n_vertices);
  layer.V = touched<Vec3>(n_vertices);
  layer.role.resize(n_vertices);
  layer.C = touched<Tet>(begin.back());
  for_each_in_blocks(used, [&](std::size_t, std::int64_t v) {
    const int at = used.rank(v);
    result.background_vertex[at] = v;
    layer.V[at] = background_.position(v);
    layer.role[at] = role(v, own);
  });
  for_each_in_blocks(movable, [&](std::size_t b, std::int64_t at) {
    tets_at(at, movable, [&](std::int64_t v, std::int64_t x, std::int64_t y, std::int64_t z) {
      if (has_own(v, x, y, z)) layer.C[begin[b]++] = {used.rank(v), used.rank(x), used.rank(y), used.rank(z)};
    });
  });
  list_rings(layer);
  set_sizes_and_colours(result);
  return result;
}

BackgroundLayer Builder::build(const IdList& movable) const {
  BackgroundLayer result;
  ActiveLayer& layer = result.layer;
  IdList used;
  for (const std::int64_t at : movable.ids()) {
    tets_at(at, movable, [&](std::int64_t v, std::int64_t x, std::int64_t y, std::int64_t z) {
      layer.C.push_back({used.add(v), used.add(x), used.add(y), used.add(z)});
    });
  }
  result.background_vertex = used.ids();
  std::sort(result.background_vertex.begin(), result.background_vertex.end());
  layer.h = background_.h();
  std::vector<int> rank(used.ids().size());
  for (const std::int64_t v : result.background_vertex) {
    rank[static_cast<std::size_t>(used.find(v))] = static_cast<int>(layer.V.size());
    layer.V.push_back(background_.position(v));
    layer.role.push_back(role(v, movable));
  }
  for (Tet& t : layer.C) {
    for (int& v : t) v = rank[v];
  }
  list_rings(layer);
  set_sizes_and_colours(result);
  return result;
}

/// Colours are those of the vertex types, or greedy ones outside of lattices.
void Builder::set_sizes_and_colours(BackgroundLayer& made) const {
  ActiveLayer& layer = made.layer;
  if (!links_.is_lattice()) {
    layer.local_h.reserve(layer.V.size());
    for (const std::int64_t v : made.background_vertex) layer.local_h.push_back(links_.at(v).unit * background_.h());
    colour_greedily(layer);
    return;
  }
  const std::vector<int> colours = type_colours();
  layer.colour.resize(layer.V.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, layer.V.size(), kVerticesPerTask), [&](const auto& range) {
    for (std::size_t v = range.begin(); v != range.end(); ++v) {
      layer.colour[v] = colours[background_.type(made.background_vertex[v])];
    }
  });
}

}  // namespace

IdSet movable_vertices(const BackgroundMesh& background, const VertexLinks& links, const IdSet& inside, int layers) {
  IdSet movable(background.n_vertices());
  for_each_in_blocks(inside, [&](std::size_t, std::int64_t v) {
    links.for_each(v, [&](std::int64_t w) {
      if (!inside.test(w)) movable.insert_shared(w);
    });
  });
  IdSet front = movable;
  for (int layer = 0; layer < layers; ++layer) {
    IdSet next(background.n_vertices());
    for_each_in_blocks(front, [&](std::size_t, std::int64_t v) {
      links.for_each(v, [&](std::int64_t w) {
        if (inside.test_any(w) && !movable.test(w)) next.insert_shared(w);
      });
    });
    bool is_more = false;
    for (std::size_t w = 0; w < next.n_words(); ++w) {
      is_more |= next.word(w) != 0;
      movable.set_word(w, movable.word(w) | next.word(w));
    }
    if (!is_more) break;
    front = std::move(next);
  }
  return movable;
}

BackgroundLayer layer_part(const BackgroundMesh& background, const VertexLinks& links, const IdSet& inside,
                           const IdSet& movable, const IdSet& own) {
  return Builder(background, links, inside).build(movable, own);
}

BackgroundLayer linked_active_layer(const BackgroundMesh& background, const VertexLinks& links, const IdSet& inside,
                                    int layers, const IdSet* among) {
  IdSet movable = movable_vertices(background, links, inside, layers);
  for (std::size_t w = 0; among && w < movable.n_words(); ++w) movable.set_word(w, movable.word(w) & among->word(w));
  return layer_part(background, links, inside, movable, movable);
}

std::vector<std::uint8_t> inside_of(const BackgroundLayer& layer, const IdSet& inside) {
  std::vector<std::uint8_t> list;
  list.reserve(layer.background_vertex.size());
  for (const std::int64_t v : layer.background_vertex) list.push_back(inside.test(v));
  return list;
}

BackgroundLayer active_patch(const BackgroundMesh& background, const VertexLinks& links, const IdSet& inside,
                             const std::vector<std::int64_t>& centres, int reach) {
  const Builder builder(background, links, inside);
  IdList ball;
  for (const std::int64_t v : centres) ball.add(v);
  std::size_t fresh = 0;
  for (int ring = 0; ring < reach; ++ring) {
    for (const std::size_t end = ball.ids().size(); fresh < end; ++fresh) {
      const std::int64_t v = ball.ids()[fresh];
      links.for_each(v, [&](std::int64_t w) {
        // Steps from the outermost cells of a lattice may lead out of the range of ids.
        if (w >= 0 && w < background.n_vertices()) ball.add(w);
      });
    }
  }
  std::vector<std::int64_t> ids = ball.ids();
  std::erase_if(ids, [&](std::int64_t v) { return !builder.in_omega_h(v); });
  std::sort(ids.begin(), ids.end());
  IdList reached;
  for (const std::int64_t v : ids) reached.add(v);
  return builder.build(reached);
}

}  // namespace umtet
