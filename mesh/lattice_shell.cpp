#include "mesh/lattice_shell.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "mesh/detail/link_steps.h"

namespace umtet {
namespace {

using detail::IdSet;

// Of 64 vertices each, a hundred of them in the shell if it is thick.
constexpr std::size_t kWordsPerBlock = 16;

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
      : background_(background), links_(links), inside_(inside), steps_(background) {}

  const std::vector<std::int64_t>& steps(std::int64_t v) const { return steps_.at(v); }
  LinkMask mask(std::int64_t v) const { return steps_.mask(v, inside_); }
  /// A vertex of omega_h, if v is an id at all.
  bool in_omega_h(std::int64_t v) const { return inside_.test_any(v) || mask(v) != 0; }

  /// Calls f(block, v) for the members of a set, threads over blocks of the same ids whatever their number.
  template <class F>
  static void for_each_in_blocks(const IdSet& set, const F& f);
  static std::size_t n_blocks(const IdSet& set) { return (set.n_words() + kWordsPerBlock - 1) / kWordsPerBlock; }

  LatticeShell build(const IdSet& movable) const;
  LatticeShell build(const SmallSet& movable) const;

 private:
  std::vector<int> type_colours() const;
  template <class Movable, class F>
  void tets_at(std::int64_t v, const Movable& movable, const F& f) const;
  template <class F>
  void ring_vertices(std::int64_t v, const F& f) const;
  template <class Movable>
  Shell::Role role(std::int64_t v, const Movable& movable) const;

  const BackgroundMesh& background_;
  const std::vector<LinkTopology>& links_;
  const IdSet& inside_;
  detail::LinkSteps steps_;
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

template <class F>
void Builder::for_each_in_blocks(const IdSet& set, const F& f) {
  tbb::parallel_for(std::size_t{0}, n_blocks(set), [&](std::size_t b) {
    const std::size_t end = std::min(set.n_words(), (b + 1) * kWordsPerBlock);
    for (std::size_t w = b * kWordsPerBlock; w < end; ++w) {
      for (std::uint64_t bits = set.word(w); bits != 0; bits &= bits - 1) {
        f(b, static_cast<std::int64_t>(w * 64) + std::countr_zero(bits));
      }
    }
  });
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
Shell::Role Builder::role(std::int64_t v, const Movable& movable) const {
  if (!movable.test(v)) return Shell::Role::Fixed;
  const bool positive = !inside_.test(v) && links_[background_.type(v)].state(mask(v)).n_positive_faces > 0;
  return positive ? Shell::Role::Boundary : Shell::Role::Inner;
}

LatticeShell Builder::build(const IdSet& movable) const {
  IdSet used(background_.n_vertices());
  std::vector<std::size_t> begin(n_blocks(movable) + 1, 0);  // of the tets
  for_each_in_blocks(movable, [&](std::size_t b, std::int64_t v) {
    ring_vertices(v, [&](std::int64_t w) { used.insert_shared(w); });
    tets_at(v, movable, [&](auto...) { ++begin[b + 1]; });
  });
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  const std::size_t n_vertices = used.index();

  LatticeShell result;
  Shell& shell = result.shell;
  shell.h = background_.h();
  result.background_vertex.resize(n_vertices);
  shell.V.resize(n_vertices);
  shell.colour.resize(n_vertices);
  shell.role.resize(n_vertices);
  shell.C.resize(begin.back());
  const std::vector<int> colours = type_colours();
  for_each_in_blocks(used, [&](std::size_t, std::int64_t v) {
    const int at = used.rank(v);
    result.background_vertex[at] = v;
    shell.V[at] = background_.position(v);
    shell.colour[at] = colours[background_.type(v)];
    shell.role[at] = role(v, movable);
  });
  for_each_in_blocks(movable, [&](std::size_t b, std::int64_t at) {
    tets_at(at, movable, [&](std::int64_t v, std::int64_t x, std::int64_t y, std::int64_t z) {
      shell.C[begin[b]++] = {used.rank(v), used.rank(x), used.rank(y), used.rank(z)};
    });
  });
  list_rings(shell);
  return result;
}

LatticeShell Builder::build(const SmallSet& movable) const {
  std::vector<std::array<std::int64_t, 4>> tets;
  std::vector<std::int64_t> ids;
  movable.for_each([&](std::int64_t at) {
    tets_at(at, movable, [&](std::int64_t v, std::int64_t x, std::int64_t y, std::int64_t z) {
      tets.push_back({v, x, y, z});
      ids.insert(ids.end(), {v, x, y, z});
    });
  });
  const SmallSet used(std::move(ids));
  LatticeShell result;
  Shell& shell = result.shell;
  shell.h = background_.h();
  result.background_vertex = used.ids();
  const std::vector<int> colours = type_colours();
  for (const std::int64_t v : used.ids()) {
    shell.V.push_back(background_.position(v));
    shell.colour.push_back(colours[background_.type(v)]);
    shell.role.push_back(role(v, movable));
  }
  for (const auto& t : tets) shell.C.push_back({used.rank(t[0]), used.rank(t[1]), used.rank(t[2]), used.rank(t[3])});
  list_rings(shell);
  return result;
}

}  // namespace

LatticeShell lattice_shell(const BackgroundMesh& background, const std::vector<LinkTopology>& links,
                           const IdSet& inside, int layers) {
  const Builder builder(background, links, inside);
  IdSet movable(background.n_vertices());
  Builder::for_each_in_blocks(inside, [&](std::size_t, std::int64_t v) {
    for (const std::int64_t step : builder.steps(v)) {
      if (!inside.test(v + step)) movable.insert_shared(v + step);
    }
  });
  IdSet front = movable;
  for (int layer = 0; layer < layers; ++layer) {
    IdSet next(background.n_vertices());
    Builder::for_each_in_blocks(front, [&](std::size_t, std::int64_t v) {
      for (const std::int64_t step : builder.steps(v)) {
        if (inside.test_any(v + step) && !movable.test(v + step)) next.insert_shared(v + step);
      }
    });
    for (std::size_t w = 0; w < next.n_words(); ++w) movable.set_word(w, movable.word(w) | next.word(w));
    front = std::move(next);
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
