#include "mesh/lattice_shell.h"

#include <algorithm>
#include <array>
#include <bit>
#include <stdexcept>
#include <utility>

namespace umtet {
namespace {

using detail::IdSet;

/// Few ids, where a set of bits for the whole background would cost more than all the rest.
class SmallSet {
 public:
  explicit SmallSet(std::vector<std::int64_t> ids) : ids_(std::move(ids)) {
    std::sort(ids_.begin(), ids_.end());
    ids_.erase(std::unique(ids_.begin(), ids_.end()), ids_.end());
  }
  bool test(std::int64_t id) const { return std::binary_search(ids_.begin(), ids_.end(), id); }
  bool test_any(std::int64_t id) const { return test(id); }
  int rank(std::int64_t id) const {
    return static_cast<int>(std::lower_bound(ids_.begin(), ids_.end(), id) - ids_.begin());
  }
  template <class F>
  void for_each(F&& f) const {
    for (const std::int64_t id : ids_) f(id);
  }
  const std::vector<std::int64_t>& ids() const { return ids_; }

 private:
  std::vector<std::int64_t> ids_;
};

class Builder {
 public:
  Builder(const BackgroundMesh& background, const std::vector<LinkTopology>& links, const IdSet& inside)
      : background_(background), links_(links), inside_(inside), steps_(background.n_types()) {
    for (int type = 0; type < background.n_types(); ++type) {
      for (const Tiling::Corner& c : background.tiling_tables().link[type])
        steps_[type].push_back(background.id_step(type, c));
    }
  }

  const std::vector<std::int64_t>& steps(std::int64_t v) const { return steps_[background_.type(v)]; }
  /// Inside vertices are off the rim, so that a step out of the range of ids or to a wrong id in the outermost cells
  /// finds none of them.
  std::uint16_t mask(std::int64_t v) const {
    unsigned mask = 0, k = 0;
    for (const std::int64_t step : steps(v)) mask |= static_cast<unsigned>(inside_.test_any(v + step)) << k++;
    return static_cast<std::uint16_t>(mask);
  }
  /// A vertex of omega_h, if v is an id at all.
  bool in_omega_h(std::int64_t v) const { return inside_.test_any(v) || mask(v) != 0; }

  template <class Movable>
  LatticeShell build(const Movable& movable) const;

 private:
  std::vector<int> type_colours() const;
  template <class Movable, class F>
  void for_each_tet(const Movable& movable, const F& f) const;

  const BackgroundMesh& background_;
  const std::vector<LinkTopology>& links_;
  const IdSet& inside_;
  std::vector<std::vector<std::int64_t>> steps_;
};

std::vector<int> Builder::type_colours() const {
  std::vector<int> colour(background_.n_types(), -1);
  for (int type = 0; type < background_.n_types(); ++type) {
    unsigned taken = 0;
    for (const Tiling::Corner& c : background_.tiling_tables().link[type]) {
      if (c.type == type) throw std::invalid_argument("tiling: a vertex type that is its own neighbour");
      if (colour[c.type] >= 0) taken |= 1u << colour[c.type];
    }
    colour[type] = std::countr_one(taken);
  }
  return colour;
}

/// f(v, a, b, c) for every tet of omega_h with a movable vertex, once: at the lowest one of them.
template <class Movable, class F>
void Builder::for_each_tet(const Movable& movable, const F& f) const {
  movable.for_each([&](std::int64_t v) {
    const LinkTopology& link = links_[background_.type(v)];
    const auto& step = steps(v);
    const unsigned in = inside_.test(v) ? ~0u : mask(v);
    unsigned lower = 0;
    for (int k = 0; k < link.n; ++k) {
      lower |= static_cast<unsigned>(step[k] < 0 && movable.test_any(v + step[k])) << k;
    }
    for (const auto& t : link.triangles) {
      const unsigned corners = 1u << t[0] | 1u << t[1] | 1u << t[2];
      if ((in & corners) != 0 && (lower & corners) == 0) f(v, v + step[t[0]], v + step[t[1]], v + step[t[2]]);
    }
  });
}

template <class Movable>
LatticeShell Builder::build(const Movable& movable) const {
  LatticeShell result;
  Shell& shell = result.shell;
  shell.h = background_.h();
  const std::vector<int> colours = type_colours();
  const auto number = [&](const auto& used) {
    used.for_each([&](std::int64_t v) {
      result.background_vertex.push_back(v);
      shell.V.push_back(background_.position(v));
      shell.colour.push_back(colours[background_.type(v)]);
      Shell::Role role = Shell::Role::Fixed;
      if (movable.test(v)) {
        const LinkTopology& link = links_[background_.type(v)];
        const bool positive = !inside_.test(v) && link.states[mask(v)].n_positive_faces > 0;
        role = positive ? Shell::Role::Boundary : Shell::Role::Inner;
      }
      shell.role.push_back(role);
    });
    for_each_tet(movable, [&](std::int64_t v, std::int64_t a, std::int64_t b, std::int64_t c) {
      shell.C.push_back({used.rank(v), used.rank(a), used.rank(b), used.rank(c)});
    });
  };
  if constexpr (std::is_same_v<Movable, SmallSet>) {
    std::vector<std::int64_t> ids;
    for_each_tet(movable, [&](std::int64_t v, std::int64_t a, std::int64_t b, std::int64_t c) {
      ids.insert(ids.end(), {v, a, b, c});
    });
    number(SmallSet(std::move(ids)));
  } else {
    IdSet used(background_.n_vertices());
    movable.for_each([&](std::int64_t v) {
      used.insert(v);
      const bool all = inside_.test(v);
      const LinkTopology& link = links_[background_.type(v)];
      unsigned near = all ? link.full() : mask(v);
      // The ring of an outside vertex is that of its link triangles with an inside vertex.
      if (!all) {
        const unsigned in = near;
        for (const auto& t : link.triangles) {
          const unsigned corners = 1u << t[0] | 1u << t[1] | 1u << t[2];
          if ((in & corners) != 0) near |= corners;
        }
      }
      for (; near != 0; near &= near - 1) used.insert(v + steps(v)[std::countr_zero(near)]);
    });
    used.index();
    number(used);
  }
  shell.ring_begin.assign(shell.V.size() + 1, 0);
  for (const Tet& tet : shell.C) {
    for (const int v : tet) ++shell.ring_begin[v + 1];
  }
  for (std::size_t v = 0; v < shell.V.size(); ++v) shell.ring_begin[v + 1] += shell.ring_begin[v];
  shell.ring.resize(4 * shell.C.size());
  std::vector<int> next(shell.ring_begin.begin(), shell.ring_begin.end() - 1);
  for (int t = 0; t < static_cast<int>(shell.C.size()); ++t) {
    for (const int v : shell.C[t]) shell.ring[next[v]++] = t;
  }
  return result;
}

}  // namespace

LatticeShell lattice_shell(const BackgroundMesh& background, const std::vector<LinkTopology>& links,
                           const IdSet& inside, int layers) {
  const Builder builder(background, links, inside);
  IdSet movable(background.n_vertices());
  std::vector<std::int64_t> front, next;
  inside.for_each([&](std::int64_t v) {
    for (const std::int64_t step : builder.steps(v)) {
      if (inside.test(v + step) || movable.test(v + step)) continue;
      movable.insert(v + step);
      front.push_back(v + step);
    }
  });
  for (int layer = 0; layer < layers; ++layer) {
    next.clear();
    for (const std::int64_t v : front) {
      for (const std::int64_t step : builder.steps(v)) {
        if (!inside.test_any(v + step) || movable.test(v + step)) continue;
        movable.insert(v + step);
        next.push_back(v + step);
      }
    }
    front.swap(next);
  }
  return builder.build(movable);
}

LatticeShell lattice_patch(const BackgroundMesh& background, const std::vector<LinkTopology>& links,
                           const IdSet& inside, const std::vector<std::int64_t>& centres, int reach) {
  const Builder builder(background, links, inside);
  std::vector<std::int64_t> ball = centres;
  std::size_t fresh = 0;
  for (int ring = 0; ring < reach; ++ring) {
    const std::size_t end = ball.size();
    for (; fresh < end; ++fresh) {
      const std::int64_t v = ball[fresh];
      for (const std::int64_t step : builder.steps(v)) ball.push_back(v + step);
    }
    // New ones behind the old ones, each once.
    const auto middle = ball.begin() + static_cast<std::ptrdiff_t>(end);
    std::vector<std::int64_t> old(ball.begin(), middle);
    std::sort(old.begin(), old.end());
    std::sort(middle, ball.end());
    ball.erase(std::unique(middle, ball.end()), ball.end());
    // Steps from the outermost cells may lead out of the range of ids.
    ball.erase(std::remove_if(middle, ball.end(),
                              [&](std::int64_t v) {
                                return v < 0 || v >= background.n_vertices() ||
                                       std::binary_search(old.begin(), old.end(), v);
                              }),
               ball.end());
  }
  std::erase_if(ball, [&](std::int64_t v) { return !builder.in_omega_h(v); });
  const SmallSet reached(std::move(ball));
  return builder.build(reached);
}

}  // namespace umtet
