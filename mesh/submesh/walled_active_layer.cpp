#include "mesh/submesh/walled_active_layer.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace umtet {
namespace {

using TetIds = std::array<std::int64_t, 4>;

/// Outside vertices with an inside neighbour, and the inside vertices off the background boundary within `layers` edges
/// of them.
IdSet movable_vertices(const BackgroundMesh& background, const IdSet& inside, int layers) {
  IdSet movable(background.n_vertices());
  std::vector<std::int64_t> front, next, link;
  inside.for_each([&](std::int64_t v) {
    link.clear();
    background.link(v, link);
    for (const std::int64_t w : link) {
      if (inside.test(w) || movable.test(w)) continue;
      movable.insert(w);
      front.push_back(w);
    }
  });
  for (int layer = 0; layer < layers; ++layer) {
    next.clear();
    for (const std::int64_t v : front) {
      link.clear();
      background.link(v, link);
      for (const std::int64_t w : link) {
        if (!inside.test(w) || movable.test(w) || background.on_boundary(w)) continue;
        movable.insert(w);
        next.push_back(w);
      }
    }
    front.swap(next);
  }
  return movable;
}

/// The tets of omega_h with a movable vertex, each once: with its lowest one.
std::vector<TetIds> moving_tets(const BackgroundMesh& background, const IdSet& inside, const IdSet& movable) {
  std::vector<TetIds> tets;
  std::vector<std::int64_t> star;
  movable.for_each([&](std::int64_t v) {
    star.clear();
    background.star(v, star);
    for (const std::int64_t t : star) {
      const TetIds tet = background.tet(t);
      const bool in_omega_h = std::any_of(tet.begin(), tet.end(), [&](std::int64_t w) { return inside.test(w); });
      const bool lowest =
          std::none_of(tet.begin(), tet.end(), [&](std::int64_t w) { return w < v && movable.test(w); });
      if (in_omega_h && lowest) tets.push_back(tet);
    }
  });
  return tets;
}

}  // namespace

BackgroundLayer walled_active_layer(const BackgroundMesh& background, const IdSet& inside, int layers) {
  const IdSet movable = movable_vertices(background, inside, layers);
  const std::vector<TetIds> tets = moving_tets(background, inside, movable);
  IdSet used(background.n_vertices()), positive(background.n_vertices());
  for (const TetIds& tet : tets) {
    const auto n_inside = std::count_if(tet.begin(), tet.end(), [&](std::int64_t v) { return inside.test(v); });
    for (const std::int64_t v : tet) {
      used.insert(v);
      if (n_inside == 1 && !inside.test(v)) positive.insert(v);
    }
  }
  BackgroundLayer result;
  ActiveLayer& layer = result.layer;
  layer.h = background.h();
  used.index();
  used.for_each([&](std::int64_t v) {
    result.background_vertex.push_back(v);
    layer.V.push_back(background.position(v));
    if (!background.is_lattice()) layer.local_h.push_back(background.h(v));
    layer.role.push_back(!movable.test(v)   ? ActiveLayer::Role::Fixed
                         : positive.test(v) ? ActiveLayer::Role::Boundary
                                            : ActiveLayer::Role::Inner);
  });
  layer.C.reserve(tets.size());
  for (const TetIds& tet : tets) {
    layer.C.push_back({used.rank(tet[0]), used.rank(tet[1]), used.rank(tet[2]), used.rank(tet[3])});
  }
  list_rings(layer);
  colour_greedily(layer);
  return result;
}

}  // namespace umtet
