#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "mesh/base/check_indices.h"
#include "mesh/certify/boundary_surface.h"
#include "mesh/core/face_uses.h"
#include "mesh/core/two_least.h"

namespace umtet {
namespace {

// Tets a task: a fraction of a millisecond. Vertices a block: their tets fit into the cache.
constexpr std::size_t kTetsPerPart = 1 << 14;
constexpr std::size_t kAhead = 16;  // tets that are prefetched
constexpr int kLogVertices = 11, kVerticesPerBlock = 1 << kLogVertices;

/// The two least vertices of each of some tets, and whether all indices are good.
bool two_least(const Tet* tets, std::size_t n, std::size_t n_vertices, int* first, int* second) {
  int least = 0, greatest = 0;
  unsigned bad = 0;
  for (std::size_t k = 0; k < n; ++k) {  // in vector registers: no branches
    const int p = tets[k][0], q = tets[k][1], r = tets[k][2], s = tets[k][3];
    const int a = std::min(p, q), b = std::max(p, q), c = std::min(r, s), d = std::max(r, s);
    const int v0 = std::min(a, c), x = std::max(a, c), y = std::min(b, d), v3 = std::max(b, d);
    const int v1 = std::min(x, y), v2 = std::max(x, y);
    least = std::min(least, v0);
    greatest = std::max(greatest, v3);
    bad |= static_cast<unsigned>(v0 == v1) | static_cast<unsigned>(v1 == v2) | static_cast<unsigned>(v2 == v3);
    first[k] = v0;
    second[k] = v1;
  }
  return bad == 0 && least >= 0 && static_cast<std::size_t>(greatest) < n_vertices;
}

/// Some consecutive tets by the blocks of vertices under which they have faces.
class TetsByBlock {
 public:
  /// @return false if an index is out of range or repeated
  bool sort(const std::vector<Tet>& C, std::size_t part, std::size_t n_vertices, const std::vector<char>* only) {
    const std::size_t first = part * kTetsPerPart, n = std::min(C.size() - first, kTetsPerPart);
    std::array<int, kTetsPerPart> a, b;
    if (!two_least(&C[first], n, n_vertices, a.data(), b.data())) return false;
    if (only) {
      for (std::size_t k = 0; k < n; ++k) {  // a vertex of `only` takes the place of one that is not; -1: neither is
        const bool in_a = (*only)[a[k]] != 0, in_b = (*only)[b[k]] != 0;
        const int one = in_a ? a[k] : in_b ? b[k] : -1;
        b[k] = in_b ? b[k] : one;
        a[k] = one;
      }
    }
    int least = std::numeric_limits<int>::max(), greatest = -1;
    for (std::size_t k = 0; k < n; ++k) {
      a[k] >>= kLogVertices;
      b[k] >>= kLogVertices;
      least = std::min(least, a[k] < 0 ? least : std::min(a[k], b[k]));
      greatest = std::max(greatest, std::max(a[k], b[k]));
    }
    if (greatest < 0) return true;
    first_block_ = static_cast<std::size_t>(least);
    begin_.assign(static_cast<std::size_t>(greatest - least) + 2, 0);
    const auto for_each = [&](const auto& f) {
      for (std::size_t k = 0; k < n; ++k) {
        if (a[k] < 0) continue;
        f(begin_[a[k] - least], k);
        if (b[k] != a[k]) f(begin_[b[k] - least], k);
      }
    };
    for_each([](std::uint32_t& count, std::size_t) { ++count; });
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());  // the ends, which go down to the beginnings
    tets_.resize(begin_.back());
    for_each([&](std::uint32_t& end, std::size_t k) { tets_[--end] = static_cast<int>(first + k); });
    return true;
  }
  std::span<const int> operator[](std::size_t block) const {
    if (block < first_block_ || block + 1 >= first_block_ + begin_.size()) return {};
    const std::size_t k = block - first_block_;
    return {tets_.data() + begin_[k], begin_[k + 1] - begin_[k]};
  }

 private:
  std::size_t first_block_ = 0;
  std::vector<std::uint32_t> begin_;
  std::vector<int> tets_;
};

/// The tets of a block with faces under a vertex, as seen from there.
class TetsByVertex {
 public:
  struct Least {
    int i, j, k, tet;  ///< the face opposite to the vertex, which is the least of the tet
  };
  struct Second {
    int i, j, tet;  ///< the other vertices, without the least of the tet, in the order of the face opposite to this one
  };
  void sort(const std::vector<Tet>& C, const std::vector<TetsByBlock>& parts, std::size_t block) {
    const int first = static_cast<int>(block << kLogVertices);
    begin_least_.fill(0);
    begin_second_.fill(0);
    const auto for_each = [&](const auto& f) {
      for (const TetsByBlock& part : parts) {
        const std::span<const int> tets = part[block];
        for (std::size_t k = 0; k < tets.size(); ++k) {
          const int t = tets[k];
          __builtin_prefetch(&C[tets[std::min(k + kAhead, tets.size() - 1)]]);
          const TwoLeast v(C[t]);
          f(t, v, static_cast<unsigned>(v.first - first), static_cast<unsigned>(v.second - first));
        }
      }
    };
    for_each([&](int, const TwoLeast&, unsigned a, unsigned b) {
      if (a < kVerticesPerBlock) ++begin_least_[a];
      if (b < kVerticesPerBlock) ++begin_second_[b];
    });
    std::partial_sum(begin_least_.begin(), begin_least_.end(), begin_least_.begin());
    std::partial_sum(begin_second_.begin(), begin_second_.end(), begin_second_.begin());
    least_.resize(begin_least_.back());
    second_.resize(begin_second_.back());
    for_each([&](int t, const TwoLeast& v, unsigned a, unsigned b) {
      const Tet& tet = C[t];
      const auto& face = kTetFace[place_of(tet, v.first)];
      const int i = tet[face[0]], j = tet[face[1]], k = tet[face[2]];
      if (a < kVerticesPerBlock) least_[--begin_least_[a]] = {i, j, k, t};
      if (b >= kVerticesPerBlock) return;
      // Opposite to i is the face of the least vertex, k and j, and so on around.
      const std::array<int, 5> around = {i, j, k, i, j};
      const int at = (v.second == j) + 2 * (v.second == k);
      second_[--begin_second_[b]] = {around[at + 2], around[at + 1], t};
    });
  }
  /// Of the v-th vertex of the block.
  std::span<const Least> least(int v) const {
    return {least_.data() + begin_least_[v], least_.data() + begin_least_[v + 1]};
  }
  std::span<const Second> second(int v) const {
    return {second_.data() + begin_second_[v], second_.data() + begin_second_[v + 1]};
  }
  /// Whether the faces under v are those under w, one after the other, with all their vertices v - w further on.
  bool is_shifted(int v, int w) const {
    const std::span<const Least> a = least(v), b = least(w);
    const std::span<const Second> c = second(v), d = second(w);
    if (a.size() != b.size() || c.size() != d.size()) return false;
    const int shift = v - w;
    int differ = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
      differ |= (a[k].i - b[k].i) ^ shift;
      differ |= (a[k].j - b[k].j) ^ shift;
      differ |= (a[k].k - b[k].k) ^ shift;
      if (differ != 0) return false;
    }
    for (std::size_t k = 0; k < c.size(); ++k) {
      differ |= (c[k].i - d[k].i) ^ shift;
      differ |= (c[k].j - d[k].j) ^ shift;
    }
    return differ == 0;
  }

 private:
  static int place_of(const Tet& tet, int v) { return (tet[1] == v) + 2 * (tet[2] == v) + 3 * (tet[3] == v); }

  std::array<std::uint32_t, kVerticesPerBlock + 1> begin_least_, begin_second_;
  std::vector<Least> least_;
  std::vector<Second> second_;
};

/// The faces under a vertex as a hash table of the directed edges opposite to it.
class Link {
 public:
  /// False where some face has more than two tets, or two on one side; or where there are more faces than the table
  /// holds. Of no further use then.
  bool is_simple(std::span<const TetsByVertex::Least> least, std::span<const TetsByVertex::Second> second) {
    const std::size_t n_uses = 3 * least.size() + second.size();
    log_slots_ = n_uses < kSlots / 4 ? kLogSlots - 2 : kLogSlots;  // fewer are cleared sooner
    if (n_uses >= kSlots) return false;
    std::fill_n(edge_.begin(), 1 << log_slots_, 0);
    std::fill_n(seen_.begin(), 1 << log_slots_, 0);
    n_single_ = 0;
    bool good = true;
    for (const TetsByVertex::Least& t : least) {
      good &= add(t.i, t.j, t.tet);
      good &= add(t.j, t.k, t.tet);
      good &= add(t.k, t.i, t.tet);
    }
    for (const TetsByVertex::Second& t : second) good &= add(t.i, t.j, t.tet);
    return good;
  }
  bool is_closed() const { return n_single_ == 0; }
  /// Calls f(tet, vertex, vertex) for the faces of one tet.
  template <class F>
  void for_each_single(const F& f) const {
    for (unsigned slot = 0; slot >> log_slots_ == 0; ++slot) {
      if (seen_[slot] == 1 || seen_[slot] == 2) {
        f(tet_[slot], static_cast<int>(edge_[slot] >> 32), static_cast<int>(edge_[slot] & 0xffffffffu));
      }
    }
  }

 private:
  static constexpr unsigned kLogSlots = 8, kSlots = 1 << kLogSlots;

  /// @return whether the edge was not there in this direction. Without a branch: half of the edges are new.
  bool add(int from, int to, int tet) {
    const std::uint64_t key =
        static_cast<std::uint64_t>(std::min(from, to)) << 32 | static_cast<std::uint64_t>(std::max(from, to));
    unsigned slot = static_cast<unsigned>((key * 0x9e3779b97f4a7c15u) >> (64 - log_slots_));
    // On to the next slot while this one holds another edge. 0 is a free slot, and no key.
    while (std::min(edge_[slot], edge_[slot] ^ key) != 0) slot = (slot + 1) & ((1u << log_slots_) - 1);
    const unsigned bit = from < to ? 1 : 2, before = seen_[slot];
    edge_[slot] = key;
    tet_[slot] = tet;
    seen_[slot] = static_cast<unsigned char>(before | bit);
    n_single_ += 1 - 2 * static_cast<int>(before != 0);
    return (before & bit) == 0;
  }

  std::array<std::uint64_t, kSlots> edge_;  ///< the lesser end above the greater; 0: none
  std::array<int, kSlots> tet_;             ///< the last one
  std::array<unsigned char, kSlots> seen_;  ///< bits: along ascending vertices, against
  unsigned log_slots_ = kLogSlots;          ///< in use
  int n_single_ = 0;
};

/// The vertices of a block whose faces all have two tets, one on either side. In the rows of a lattice the faces under
/// a vertex are those under an earlier one with the same number added to all vertices: these need no hash table.
class ClosedVertices {
 public:
  void clear() { closed_.fill(false); }
  void insert(int v) { closed_[v] = true; }
  /// Inserts v if its faces are those of a member before it. @return whether they are
  bool insert_copy(const TetsByVertex& tets, int v) { return closed_[v] = repeats(tets, v); }

 private:
  bool repeats(const TetsByVertex& tets, int v) {
    const auto is_copy = [&](int step) { return step <= v && closed_[v - step] && tets.is_shifted(v, v - step); };
    if (is_copy(step_)) return true;
    if (++n_others_ % kOthersPerSearch != 0) return false;
    for (int step = 1; step <= kMostSteps; ++step) {
      if (step == step_ || !is_copy(step)) continue;
      step_ = step;
      return true;
    }
    return false;
  }

  // A lattice has one step from a vertex to its copy, which is soon found. A mesh without one is searched seldom.
  static constexpr int kMostSteps = 32;
  static constexpr unsigned kOthersPerSearch = 16;

  std::array<bool, kVerticesPerBlock> closed_{};
  int step_ = 1;  ///< the step from a vertex to the copy that was found last
  unsigned n_others_ = 0;
};

struct BlockFaces {
  std::vector<std::int64_t> single;  ///< 4 tet + local face
  std::size_t n_overused = 0, n_same_side = 0;
};

/// The faces whose least vertex is v, whatever they are.
void count_faces(const std::vector<Tet>& C, const TetsByVertex& tets, int v, int local, std::vector<FaceUse>& uses,
                 BlockFaces& result) {
  uses.clear();
  for (const auto& t : tets.least(local)) add_faces(C[t.tet], static_cast<std::size_t>(t.tet), v, uses);
  for (const auto& t : tets.second(local)) add_faces(C[t.tet], static_cast<std::size_t>(t.tet), v, uses);
  for_each_face(uses, [&](std::span<const FaceUse> face) {
    if (face.size() == 1) result.single.push_back(static_cast<std::int64_t>(face[0].place()));
    if (face.size() == 2) result.n_same_side += face[0].reversed() == face[1].reversed();
    if (face.size() > 2) ++result.n_overused;
  });
}

/// 4 tet + the local face with these corners.
std::int64_t face_of(const std::vector<Tet>& C, int t, int a, int b, int c) {
  int k = 0;
  while (C[t][k] == a || C[t][k] == b || C[t][k] == c) ++k;
  return 4 * static_cast<std::int64_t>(t) + k;
}

/// What a thread keeps from block to block.
struct Scratch {
  TetsByVertex tets;
  ClosedVertices closed;
  Link link;
  std::vector<FaceUse> uses;
};

}  // namespace

BoundaryFaces boundary_faces(const std::vector<Tet>& C, std::size_t n_vertices, const std::vector<char>* only) {
  std::vector<TetsByBlock> parts((C.size() + kTetsPerPart - 1) / kTetsPerPart);
  std::atomic<bool> good = true;
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t p) {
    if (!parts[p].sort(C, p, n_vertices, only)) good = false;
  });
  if (!good) check_indices(C, n_vertices, "tet");  // throws
  std::vector<BlockFaces> blocks((n_vertices + kVerticesPerBlock - 1) / kVerticesPerBlock);
  tbb::enumerable_thread_specific<Scratch> scratch;
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
    auto& [tets, closed, link, uses] = scratch.local();
    const auto first = static_cast<int>(b << kLogVertices);
    const auto n = static_cast<int>(std::min<std::size_t>(kVerticesPerBlock, n_vertices - (b << kLogVertices)));
    tets.sort(C, parts, b);
    closed.clear();
    for (int k = 0; k < n; ++k) {
      const int v = first + k;
      if (only && (*only)[v] == 0) continue;
      if (closed.insert_copy(tets, k)) continue;
      if (!link.is_simple(tets.least(k), tets.second(k))) {
        count_faces(C, tets, v, k, uses, blocks[b]);
      } else if (link.is_closed()) {
        closed.insert(k);
      } else {
        link.for_each_single([&](int t, int i, int j) { blocks[b].single.push_back(face_of(C, t, v, i, j)); });
      }
    }
  });
  BoundaryFaces result;
  std::vector<std::int64_t> single;
  for (const BlockFaces& block : blocks) {
    single.insert(single.end(), block.single.begin(), block.single.end());
    result.n_overused += block.n_overused;
    result.n_same_side += block.n_same_side;
  }
  tbb::parallel_sort(single.begin(), single.end());
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
