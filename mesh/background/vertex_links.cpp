#include "mesh/background/vertex_links.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <numeric>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>

#include "mesh/core/tet_mesh.h"

namespace umtet {
namespace {

// Link vertices are put in an order by their places around the vertex, to within this part of its edge length: the
// same order wherever the mesh looks the same, whatever rounding or optimisation has done to the places.
constexpr double kParts = 8;
// Edge lengths of one type differ by a 64th of an octave at most, one percent.
constexpr double kStepsPerOctave = 64;
// A type with so many vertices for each state that its masks may have gets a table of them: then few of them are
// computed in vain.
constexpr std::size_t kStatesPerVertex = 4;
constexpr int kMostInTable = 16;
constexpr std::int64_t kVerticesPerTask = 1 << 10;  // of a microsecond or two each

class Lister {
 public:
  explicit Lister(const BackgroundMesh& background)
      : background_(background),
        n_(background.n_vertices()),
        n_tasks_(static_cast<std::size_t>((n_ + kVerticesPerTask - 1) / kVerticesPerTask)) {}

  /// Returns false where a link is too large.
  bool list_vertices(std::vector<std::size_t>& begin, std::vector<int>& vertices) const;
  void find_types(const std::vector<std::size_t>& begin, const std::vector<int>& vertices, std::vector<int>& type,
                  std::vector<LinkTopology>& topologies) const;

 private:
  template <class F>
  void for_each_task(const F& f) const {
    tbb::parallel_for(std::size_t{0}, n_tasks_, [&](std::size_t task) {
      const std::int64_t first = static_cast<std::int64_t>(task) * kVerticesPerTask;
      f(task, first, std::min(n_, first + kVerticesPerTask));
    });
  }

  const BackgroundMesh& background_;
  const std::int64_t n_;
  const std::size_t n_tasks_;
};

bool Lister::list_vertices(std::vector<std::size_t>& begin, std::vector<int>& vertices) const {
  struct Neighbour {
    std::array<std::int64_t, 3> place;  ///< z, y, x
    std::int64_t id;
    auto operator<=>(const Neighbour&) const = default;
  };
  std::vector<std::vector<int>> of_task(n_tasks_);
  begin.assign(static_cast<std::size_t>(n_) + 1, 0);
  std::atomic<bool> fits = true;
  for_each_task([&](std::size_t task, std::int64_t first, std::int64_t last) {
    std::vector<std::int64_t> link;
    std::vector<Neighbour> ordered;
    for (std::int64_t v = first; v < last; ++v) {
      link.clear();
      background_.link(v, link);
      if (link.size() > kMaxLink) fits = false;
      const Vec3 x = background_.position(v);
      const double part = background_.h(v) / kParts;
      ordered.clear();
      for (const std::int64_t w : link) {
        const Vec3 d = (background_.position(w) - x) / part;
        ordered.push_back({{std::llround(d[2]), std::llround(d[1]), std::llround(d[0])}, w});
      }
      std::sort(ordered.begin(), ordered.end());
      for (const Neighbour& w : ordered) of_task[task].push_back(static_cast<int>(w.id));
      begin[static_cast<std::size_t>(v) + 1] = ordered.size();
    }
  });
  if (!fits) return false;
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  vertices.resize(begin.back());
  for_each_task([&](std::size_t task, std::int64_t first, std::int64_t) {
    std::copy(of_task[task].begin(), of_task[task].end(),
              vertices.begin() + static_cast<std::ptrdiff_t>(begin[static_cast<std::size_t>(first)]));
  });
  return true;
}

std::uint8_t number_of(std::span<const int> link, std::int64_t w) {
  return static_cast<std::uint8_t>(std::find(link.begin(), link.end(), w) - link.begin());
}

/// As a key: the bytes of what makes a type.
std::string key_of(const LinkTopology& link) {
  std::string key(sizeof(float), '\0');
  std::copy_n(reinterpret_cast<const char*>(&link.unit), sizeof(float), key.begin());
  key.append(link.back.begin(), link.back.begin() + link.n);
  for (const auto& t : link.triangles) key.append(t.begin(), t.end());
  return key;
}

void Lister::find_types(const std::vector<std::size_t>& begin, const std::vector<int>& vertices,
                        std::vector<int>& type, std::vector<LinkTopology>& topologies) const {
  struct OfTask {
    std::unordered_map<std::string, int> number;
    std::vector<const std::string*> keys;
    std::vector<LinkTopology> topologies;
    std::vector<std::size_t> uses;
  };
  const auto link_of = [&](std::int64_t v) {
    const auto at = static_cast<std::size_t>(v);
    return std::span(vertices.data() + begin[at], begin[at + 1] - begin[at]);
  };
  std::vector<OfTask> of_task(n_tasks_);
  type.resize(static_cast<std::size_t>(n_));
  for_each_task([&](std::size_t task, std::int64_t first, std::int64_t last) {
    OfTask& own = of_task[task];
    std::vector<std::int64_t> star;
    LinkTopology link;
    for (std::int64_t v = first; v < last; ++v) {
      const std::span<const int> ring = link_of(v);
      link.n = static_cast<int>(ring.size());
      link.triangles.clear();
      star.clear();
      background_.star(v, star);
      for (const std::int64_t t : star) {
        const auto tet = background_.tet(t);
        const auto corner = static_cast<std::size_t>(std::find(tet.begin(), tet.end(), v) - tet.begin());
        const auto& f = kTetFace[corner];
        link.triangles.push_back({number_of(ring, tet[f[0]]), number_of(ring, tet[f[1]]), number_of(ring, tet[f[2]])});
        // In a cycle from the least: tets are listed by their ids, which says nothing of the shape of a link.
        auto& made = link.triangles.back();
        while (made[0] > made[1] || made[0] > made[2]) made = {made[1], made[2], made[0]};
      }
      std::sort(link.triangles.begin(), link.triangles.end());
      link.back = {};
      for (int k = 0; k < link.n; ++k) link.back[k] = number_of(link_of(ring[k]), v);
      const double octaves = std::log2(background_.h(v) / background_.h());
      link.unit = link.n == 0 ? 1 : static_cast<float>(std::exp2(std::round(octaves * kStepsPerOctave) / kStepsPerOctave));
      const auto [at, is_new] = own.number.try_emplace(key_of(link), static_cast<int>(own.topologies.size()));
      if (is_new) {
        own.keys.push_back(&at->first);
        own.topologies.push_back(link);
        own.uses.push_back(0);
      }
      type[static_cast<std::size_t>(v)] = at->second;
      ++own.uses[static_cast<std::size_t>(at->second)];
    }
  });
  // Numbered task by task, so that threads do not matter.
  std::unordered_map<std::string, int> number;
  std::vector<std::size_t> uses;
  std::vector<std::vector<int>> renumbered(n_tasks_);
  for (std::size_t task = 0; task < n_tasks_; ++task) {
    OfTask& own = of_task[task];
    for (std::size_t k = 0; k < own.topologies.size(); ++k) {
      const auto [at, is_new] = number.try_emplace(*own.keys[k], static_cast<int>(topologies.size()));
      if (is_new) {
        topologies.push_back(std::move(own.topologies[k]));
        uses.push_back(0);
      }
      uses[static_cast<std::size_t>(at->second)] += own.uses[k];
      renumbered[task].push_back(at->second);
    }
    own = {};
  }
  for_each_task([&](std::size_t task, std::int64_t first, std::int64_t last) {
    for (std::int64_t v = first; v < last; ++v) {
      int& own = type[static_cast<std::size_t>(v)];
      own = renumbered[task][static_cast<std::size_t>(own)];
    }
  });
  tbb::parallel_for(std::size_t{0}, topologies.size(), [&](std::size_t k) {
    LinkTopology& link = topologies[k];
    link.site = link.n;
    link.adjacent.assign(static_cast<std::size_t>(link.n), 0);
    for (const auto& t : link.triangles) {
      for (int a = 0; a < 3; ++a)
        link.adjacent[t[a]] |= LinkMask{1} << t[(a + 1) % 3] | LinkMask{1} << t[(a + 2) % 3];
    }
    if (link.n > kMostInTable || link.n == 0 || uses[k] * kStatesPerVertex < std::size_t{1} << link.n) return;
    link.states.resize(std::size_t{1} << link.n);
    tbb::parallel_for(std::size_t{0}, link.states.size(), [&](std::size_t m) { link.states[m] = link.find_state(m); });
  });
}

}  // namespace

VertexLinks::VertexLinks(const BackgroundMesh& lattice, const std::vector<LinkTopology>& of_types)
    : steps_(lattice), topologies_(&of_types) {}

std::shared_ptr<const VertexLinks> VertexLinks::listed(const BackgroundMesh& background) {
  Listed made;
  const Lister lister(background);
  if (!lister.list_vertices(made.begin, made.vertices)) return nullptr;
  lister.find_types(made.begin, made.vertices, made.type, made.topologies);
  return std::shared_ptr<const VertexLinks>(new VertexLinks(std::move(made)));
}

}  // namespace umtet
