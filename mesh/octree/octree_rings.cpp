#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include <algorithm>
#include <bit>

#include "mesh/octree/octree_tets.h"

namespace umtet {
namespace {

/// f(id) for every member, by all threads.
template <class F>
void for_each_member(const IdSet& ids, const F& f) {
  tbb::parallel_for(std::size_t{0}, ids.n_words(), [&](std::size_t w) {
    for (std::uint64_t bits = ids.word(w); bits != 0; bits &= bits - 1) {
      f(static_cast<std::int64_t>(w * 64) + std::countr_zero(bits));
    }
  });
}

}  // namespace

IdSet OctreeTets::with_rings(const IdSet& vertices, int rings) const {
  IdSet all = vertices, front = vertices;
  for (int ring = 0; ring < rings; ++ring) {
    IdSet next(n_vertices());
    for_each_member(front, [&](std::int64_t v) {
      Link link;
      const int n = link_of(v, link);
      for (int k = 0; k < n; ++k) {
        const std::int64_t w = link[static_cast<std::size_t>(k)];
        if (!all.test(w)) next.insert_shared(w);
      }
    });
    for (std::size_t w = 0; w < all.n_words(); ++w) all.set_word(w, all.word(w) | next.word(w));
    front = std::move(next);
  }
  return all;
}

/// cube_key() of the cube that a leaf is an eighth of, or of the root itself.
std::uint64_t OctreeTets::parent(int leaf) const {
  const int level = octree_.cell(leaf).level;
  if (level == 0) return cube_key(0, 0);
  const std::uint64_t own = std::uint64_t{7} << half_width_shift(level - 1);
  return cube_key(octree_.corner_key(leaf) & ~own, level - 1);
}

std::vector<std::uint64_t> OctreeTets::leaves_at(const IdSet& vertices) const {
  IdSet leaves(octree_.n_cells());
  for_each_member(vertices, [&](std::int64_t v) {
    if (is_centre(v)) {
      const int own = cell_of_vertex(v);
      leaves.insert_shared(own);
      for (const int behind : octree_.cell(own).neighbor) {
        if (behind >= 0) leaves.insert_shared(behind);
      }
      return;
    }
    const Around around = this->around(v);
    for (int k = 0; k < around.n; ++k) leaves.insert_shared(around.leaves[static_cast<std::size_t>(k)].first);
  });
  std::vector<std::uint64_t> parents;
  leaves.for_each([&](std::int64_t leaf) { parents.push_back(parent(static_cast<int>(leaf))); });
  tbb::parallel_sort(parents.begin(), parents.end());
  parents.erase(std::unique(parents.begin(), parents.end()), parents.end());
  std::vector<std::uint64_t> cubes;
  for (int c = 0; c < octree_.n_cells(); ++c) {
    if (!octree_.cell(c).is_leaf() || !std::binary_search(parents.begin(), parents.end(), parent(c))) continue;
    cubes.push_back(cube_key(octree_.corner_key(c), octree_.cell(c).level));
  }
  return cubes;
}

}  // namespace umtet
