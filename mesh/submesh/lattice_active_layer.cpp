#include "mesh/submesh/lattice_active_layer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "mesh/background/link_steps.h"
#include "mesh/base/id_blocks.h"
#include "mesh/base/id_list.h"

namespace umtet {
namespace {

class Builder {
 public:
  Builder(const BackgroundMesh& background, const std::vector<LinkTopology>& links, const IdSet& inside)
      : background_(background), links_(links), inside_(inside), steps_(background) {}

  const std::vector<std::int64_t>& steps(std::int64_t v) const { return steps_.at(v); }
  LinkMask mask(std::int64_t v) const { return steps_.mask(v, inside_); }
  /// A vertex of omega_h, if v is an id at all.
  bool in_omega_h(std::int64_t v) const { return inside_.test_any(v) || mask(v) != 0; }

  LatticeActiveLayer build(const IdSet& movable) const;
  /// @param movable  ascending
  LatticeActiveLayer build(const IdList& movable) const;

 private:
  std::vector<int> type_colours() const;
  template <class Movable, class F>
  void tets_at(std::int64_t v, const Movable& movable, const F& f) const;
  template <class F>
  void ring_vertices(std::int64_t v, const F& f) const;
  template <class Movable>
  ActiveLayer::Role role(std::int64_t v, const Movable& movable) const;

  const BackgroundMesh& background_;
  const std::vector<LinkTopology>& links_;
  const IdSet& inside_;
  LinkSteps steps_;
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
  const LinkTopology& link = links_[background_.type(v)];
  const auto& step = steps(v);
  const LinkMask in = inside_.test(v) ? ~LinkMask{0} : mask(v);
  LinkMask lower = 0;
  for (int k = 0; k < link.n; ++k) {
    lower |= static_cast<LinkMask>(step[k] < 0 && movable.test_any(v + step[k])) << k;
  }
  for (const auto& t : link.triangles) {
    const LinkMask corners = LinkMask{1} << t[0] | LinkMask{1} << t[1] | LinkMask{1} << t[2];
    if ((in & corners) != 0 && (lower & corners) == 0) f(v, v + step[t[0]], v + step[t[1]], v + step[t[2]]);
  }
}

/// f(w) for v and the vertices of its tets in omega_h.
template <class F>
void Builder::ring_vertices(std::int64_t v, const F& f) const {
  f(v);
  const LinkTopology& link = links_[background_.type(v)];
  LinkMask near = link.full();
  if (!inside_.test(v)) {
    // The ring of an outside vertex is that of its link triangles with an inside vertex.
    const LinkMask in = near = mask(v);
    for (const auto& t : link.triangles) {
      const LinkMask corners = LinkMask{1} << t[0] | LinkMask{1} << t[1] | LinkMask{1} << t[2];
      if ((in & corners) != 0) near |= corners;
    }
  }
  for (; near != 0; near &= near - 1) f(v + steps(v)[std::countr_zero(near)]);
}

template <class Movable>
ActiveLayer::Role Builder::role(std::int64_t v, const Movable& movable) const {
  if (!movable.test(v)) return ActiveLayer::Role::Fixed;
  const bool positive = !inside_.test(v) && links_[background_.type(v)].state(mask(v)).n_positive_faces > 0;
  return positive ? ActiveLayer::Role::Boundary : ActiveLayer::Role::Inner;
}

LatticeActiveLayer Builder::build(const IdSet& movable) const {
  IdSet used(background_.n_vertices());
  std::vector<std::size_t> begin(n_blocks(movable) + 1, 0);  // of the tets
  for_each_in_blocks(movable, [&](std::size_t b, std::int64_t v) {
    ring_vertices(v, [&](std::int64_t w) { used.insert_shared(w); });
    tets_at(v, movable, [&](auto...) { ++begin[b + 1]; });
  });
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  const std::size_t n_vertices = used.index();

  LatticeActiveLayer result;
  ActiveLayer& layer = result.layer;
  layer.h = background_.h();
  result.background_vertex.resize(n_vertices);
  layer.V.resize(n_vertices);
  layer.colour.resize(n_vertices);
  layer.role.resize(n_vertices);
  layer.C.resize(begin.back());
  const std::vector<int> colours = type_colours();
  for_each_in_blocks(used, [&](std::size_t, std::int64_t v) {
    const int at = used.rank(v);
    result.background_vertex[at] = v;
    layer.V[at] = background_.position(v);
    layer.colour[at] = colours[background_.type(v)];
    layer.role[at] = role(v, movable);
  });
  for_each_in_blocks(movable, [&](std::size_t b, std::int64_t at) {
    tets_at(at, movable, [&](std::int64_t v, std::int64_t x, std::int64_t y, std::int64_t z) {
      layer.C[begin[b]++] = {used.rank(v), used.rank(x), used.rank(y), used.rank(z)};
    });
  });
  list_rings(layer);
  return result;
}

LatticeActiveLayer Builder::build(const IdList& movable) const {
  LatticeActiveLayer result;
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
  const std::vector<int> colours = type_colours();
  std::vector<int> rank(used.ids().size());
  for (const std::int64_t v : result.background_vertex) {
    rank[static_cast<std::size_t>(used.find(v))] = static_cast<int>(layer.V.size());
    layer.V.push_back(background_.position(v));
    layer.colour.push_back(colours[background_.type(v)]);
    layer.role.push_back(role(v, movable));
  }
  for (Tet& t : layer.C) {
    for (int& v : t) v = rank[v];
  }
  list_rings(layer);
  return result;
}

}  // namespace

LatticeActiveLayer lattice_active_layer(const BackgroundMesh& background, const std::vector<LinkTopology>& links,
                                        const IdSet& inside, int layers) {
  const Builder builder(background, links, inside);
  IdSet movable(background.n_vertices());
  for_each_in_blocks(inside, [&](std::size_t, std::int64_t v) {
    for (const std::int64_t step : builder.steps(v)) {
      if (!inside.test(v + step)) movable.insert_shared(v + step);
    }
  });
  IdSet front = movable;
  for (int layer = 0; layer < layers; ++layer) {
    IdSet next(background.n_vertices());
    for_each_in_blocks(front, [&](std::size_t, std::int64_t v) {
      for (const std::int64_t step : builder.steps(v)) {
        if (inside.test_any(v + step) && !movable.test(v + step)) next.insert_shared(v + step);
      }
    });
    for (std::size_t w = 0; w < next.n_words(); ++w) movable.set_word(w, movable.word(w) | next.word(w));
    front = std::move(next);
  }
  return builder.build(movable);
}

std::vector<std::uint8_t> inside_of(const LatticeActiveLayer& layer, const IdSet& inside) {
  std::vector<std::uint8_t> list;
  list.reserve(layer.background_vertex.size());
  for (const std::int64_t v : layer.background_vertex) list.push_back(inside.test(v));
  return list;
}

LatticeActiveLayer lattice_patch(const BackgroundMesh& background, const std::vector<LinkTopology>& links,
                                 const IdSet& inside, const std::vector<std::int64_t>& centres, int reach) {
  const Builder builder(background, links, inside);
  IdList ball;
  for (const std::int64_t v : centres) ball.add(v);
  std::size_t fresh = 0;
  for (int ring = 0; ring < reach; ++ring) {
    for (const std::size_t end = ball.ids().size(); fresh < end; ++fresh) {
      const std::int64_t v = ball.ids()[fresh];
      for (const std::int64_t step : builder.steps(v)) {
        // Steps from the outermost cells may lead out of the range of ids.
        if (v + step >= 0 && v + step < background.n_vertices()) ball.add(v + step);
      }
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
