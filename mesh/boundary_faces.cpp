#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "mesh/detail/check_indices.h"
#include "mesh/detail/two_least.h"
#include "mesh/skin.h"

namespace umtet {
namespace {

using detail::TwoLeast;

// What a task of a millisecond handles; of the vertices, what leaves their tets in the cache.
constexpr std::size_t kTetsPerBlock = 1 << 16;
constexpr int kLogVertices = 12, kVerticesPerBlock = 1 << kLogVertices;

/// The tets with faces under the vertices of each block, ascending.
class TetsByBlock {
 public:
  /// @param only  per vertex, whether its tets are listed; null: of all
  TetsByBlock(const std::vector<Tet>& C, std::size_t n_vertices, const std::vector<char>* only)
      : begin_((n_vertices + kVerticesPerBlock - 1) / kVerticesPerBlock + 1, 0) {
    const std::size_t n_parts = (C.size() + kTetsPerBlock - 1) / kTetsPerBlock, n_blocks = begin_.size() - 1;
    std::vector<std::uint32_t> next(n_parts * n_blocks, 0);  // for each part of C, where its tets of a block go
    const auto for_each = [&](const auto& f) {
      tbb::parallel_for(std::size_t{0}, n_parts, [&](std::size_t part) {
        const std::size_t end = std::min(C.size(), (part + 1) * kTetsPerBlock);
        for (std::size_t t = part * kTetsPerBlock; t < end; ++t) {
          const TwoLeast least(C[t]);
          const int a = least.first >> kLogVertices, b = least.second >> kLogVertices;
          const bool in_a = !only || (*only)[least.first] != 0, in_b = !only || (*only)[least.second] != 0;
          if (in_a || (in_b && a == b)) f(t, next[part * n_blocks + static_cast<std::size_t>(a)]);
          if (in_b && a != b) f(t, next[part * n_blocks + static_cast<std::size_t>(b)]);
        }
      });
    };
    for_each([](std::size_t, std::uint32_t& n) { ++n; });
    std::uint32_t sum = 0;
    for (std::size_t block = 0; block < n_blocks; ++block) {
      for (std::size_t part = 0; part < n_parts; ++part) sum += std::exchange(next[part * n_blocks + block], sum);
      begin_[block + 1] = sum;
    }
    tets_.resize(sum);
    for_each([&](std::size_t t, std::uint32_t& n) { tets_[n++] = static_cast<int>(t); });
  }
  std::size_t size() const { return begin_.size() - 1; }
  std::span<const int> operator[](std::size_t block) const {
    return {tets_.data() + begin_[block], begin_[block + 1] - begin_[block]};
  }

 private:
  std::vector<std::uint32_t> begin_;
  std::vector<int> tets_;
};

/// The tets of a block by vertex.
class TetsByVertex {
 public:
  struct Star {
    std::span<const int> all, least, second;  ///< those it is the least vertex of, then those it is the second of
  };
  TetsByVertex(const std::vector<Tet>& C, std::span<const int> tets, int first_vertex) : first_(first_vertex) {
    const auto for_each = [&](const auto& f) {
      for (const int t : tets) {
        const TwoLeast least(C[t]);
        const int a = least.first - first_, b = least.second - first_;
        if (is_here(a)) f(t, a, true);
        if (is_here(b)) f(t, b, false);
      }
    };
    for_each([&](int, int v, bool) { ++begin_[v + 1]; });
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    std::copy(begin_.begin(), begin_.end() - 1, next_.begin());
    std::copy(begin_.begin() + 1, begin_.end(), last_.begin());
    tets_.resize(begin_.back());
    for_each([&](int t, int v, bool least) { tets_[least ? next_[v]++ : --last_[v]] = t; });
  }
  /// Of the v-th vertex of the block.
  Star operator[](int v) const {
    const int* const tets = tets_.data();
    return {{tets + begin_[v], tets + begin_[v + 1]},
            {tets + begin_[v], tets + next_[v]},
            {tets + next_[v], tets + begin_[v + 1]}};
  }

 private:
  static bool is_here(int v) { return v >= 0 && v < kVerticesPerBlock; }

  int first_;
  std::array<std::uint32_t, kVerticesPerBlock + 1> begin_{};
  std::array<std::uint32_t, kVerticesPerBlock> next_, last_;
  std::vector<int> tets_;
};

/// The directed edges opposite to a vertex in its faces, as bits of a small matrix: enough to say that every face has
/// two tets, one on either side.
class Link {
 public:
  /// Whether that is true of all faces whose least vertex is v. False, too, where there are more vertices than bits.
  bool is_closed(const std::vector<Tet>& C, const TetsByVertex::Star& star, int v) {
    n_ = 0;
    is_simple_ = true;
    for (const int t : star.least) {
      const Tet& tet = C[t];
      const auto& face = kTetFace[place_of(tet, v)];
      const int i = number(v, tet[face[0]]), j = number(v, tet[face[1]]), k = number(v, tet[face[2]]);
      add(i, j);
      add(j, k);
      add(k, i);
      if (n_ > kMost) return false;
    }
    for (const int t : star.second) {
      const Tet& tet = C[t];
      const auto& face = kTetFace[place_of(tet, v)];
      const int below = (tet[face[1]] < v) + 2 * (tet[face[2]] < v);
      add(number(v, tet[face[(below + 1) % 3]]), number(v, tet[face[(below + 2) % 3]]));
      if (n_ > kMost) return false;
    }
    return is_simple_ && std::equal(from_.begin(), from_.begin() + n_, to_.begin());
  }

 private:
  static constexpr int kLogSlots = 6, kSlots = 1 << kLogSlots;
  static constexpr int kMost = 48;  ///< vertices; a tet adds three at most

  static int place_of(const Tet& tet, int v) { return (tet[1] == v) + 2 * (tet[2] == v) + 3 * (tet[3] == v); }
  /// Of vertex x in the link of v: in the order in which they are met.
  int number(int v, int x) {
    const std::uint64_t key = static_cast<std::uint64_t>(v) << 32 | static_cast<std::uint32_t>(x);
    std::uint32_t slot = (static_cast<std::uint32_t>(x) * 2654435769u) >> (32 - kLogSlots);
    for (; key_[slot] != key; slot = (slot + 1) % kSlots) {
      if (key_[slot] >> 32 == static_cast<std::uint64_t>(v)) continue;  // another vertex of this link
      key_[slot] = key;
      number_[slot] = n_;
      from_[n_] = to_[n_] = 0;
      return n_++;
    }
    return number_[slot];
  }
  void add(int i, int j) {
    is_simple_ &= (from_[i] >> j & 1) == 0;
    from_[i] |= std::uint64_t{1} << j;
    to_[j] |= std::uint64_t{1} << i;
  }

  std::array<std::uint64_t, kSlots> key_ = [] {
    std::array<std::uint64_t, kSlots> none;
    none.fill(~std::uint64_t{0});
    return none;
  }();
  std::array<int, kSlots> number_{};
  std::array<std::uint64_t, 64> from_{}, to_{};  ///< row i: the j with an edge i -> j, j -> i
  int n_ = 0;
  bool is_simple_ = true;  ///< no edge twice in one direction
};

/// A face under its least vertex.
struct FaceUse {
  std::uint64_t rest;    ///< the other two vertices, ascending, 32 bits each
  std::uint64_t source;  ///< 2 (4 tet + local face) + 1 where it runs against ascending vertices

  bool reversed() const { return (source & 1) != 0; }
};

/// Appends the faces of a tet whose least vertex is v.
void add_faces(const Tet& tet, std::size_t t, int v, std::vector<FaceUse>& uses) {
  const auto own = std::find(tet.begin(), tet.end(), v) - tet.begin();
  for (int k = 0; k < 4; ++k) {
    if (k == own) continue;
    const auto& f = kTetFace[k];
    // The face from v on: it is a cycle.
    const int at = f[0] == own ? 0 : f[1] == own ? 1 : 2;
    const int p = tet[f[(at + 1) % 3]], q = tet[f[(at + 2) % 3]];
    if (p < v || q < v) continue;
    const auto low = static_cast<std::uint64_t>(std::min(p, q)), high = static_cast<std::uint64_t>(std::max(p, q));
    uses.push_back({low << 32 | high, 2 * (4 * t + static_cast<std::uint64_t>(k)) + (p > q ? 1 : 0)});
  }
}

struct BlockFaces {
  std::vector<std::int64_t> single;  ///< 4 tet + local face
  std::size_t n_overused = 0, n_same_side = 0;
};

/// The faces whose least vertex is v, where they are not all inside.
void count_faces(const std::vector<Tet>& C, std::span<const int> tets, int v, std::vector<FaceUse>& uses,
                 BlockFaces& result) {
  uses.clear();
  for (const int t : tets) add_faces(C[t], static_cast<std::size_t>(t), v, uses);
  std::sort(uses.begin(), uses.end(), [](const FaceUse& x, const FaceUse& y) { return x.rest < y.rest; });
  for (std::size_t i = 0, j = 0; i < uses.size(); i = j) {
    while (j < uses.size() && uses[j].rest == uses[i].rest) ++j;
    if (j - i == 1) result.single.push_back(static_cast<std::int64_t>(uses[i].source / 2));
    if (j - i == 2) result.n_same_side += uses[i].reversed() == uses[i + 1].reversed();
    if (j - i > 2) ++result.n_overused;
  }
}

}  // namespace

BoundaryFaces boundary_faces(const std::vector<Tet>& C, std::size_t n_vertices, const std::vector<char>* only) {
  detail::check_indices(C, n_vertices, "tet");
  const TetsByBlock table(C, n_vertices, only);
  std::vector<BlockFaces> blocks(table.size());
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
    const auto first = static_cast<int>(b << kLogVertices);
    const auto n = static_cast<int>(std::min<std::size_t>(kVerticesPerBlock, n_vertices - (b << kLogVertices)));
    const TetsByVertex stars(C, table[b], first);
    Link link;
    std::vector<FaceUse> uses;
    for (int v = 0; v < n; ++v) {
      if (only && (*only)[first + v] == 0) continue;
      const TetsByVertex::Star star = stars[v];
      if (!link.is_closed(C, star, first + v)) count_faces(C, star.all, first + v, uses, blocks[b]);
    }
  });
  BoundaryFaces result;
  std::vector<std::int64_t> single;
  for (const BlockFaces& block : blocks) {
    single.insert(single.end(), block.single.begin(), block.single.end());
    result.n_overused += block.n_overused;
    result.n_same_side += block.n_same_side;
  }
  std::sort(single.begin(), single.end());
  result.triangles.reserve(single.size());
  result.tets.reserve(single.size());
  for (const std::int64_t s : single) {
    const auto& f = kTetFace[s % 4];
    const Tet& t = C[s / 4];
    result.triangles.push_back({t[f[0]], t[f[1]], t[f[2]]});
    result.tets.push_back(static_cast<int>(s / 4));
  }
  return result;
}

}  // namespace umtet
