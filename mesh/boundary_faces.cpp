#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "mesh/detail/check_indices.h"
#include "mesh/skin.h"

namespace umtet {
namespace {

// A task of some hundred microseconds.
constexpr std::size_t kVerticesPerBlock = 1 << 10;

/// The tets at each vertex that is the least or the second least of theirs: no other has a face under it.
class TetsByVertex {
 public:
  /// @param only  per vertex, whether its tets are listed; null: of all
  TetsByVertex(const std::vector<Tet>& C, std::size_t n_vertices, const std::vector<char>* only)
      : begin_(n_vertices + 2, 0) {
    const auto listed = [&](int v) { return !only || (*only)[v] != 0; };
    for (const Tet& t : C) {
      for (const int v : two_least(t)) begin_[v + 2] += listed(v);
    }
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    tets_.resize(begin_.back());
    for (std::size_t t = 0; t < C.size(); ++t) {
      for (const int v : two_least(C[t])) {
        if (listed(v)) tets_[begin_[v + 1]++] = static_cast<int>(t);
      }
    }
  }
  std::span<const int> operator[](int v) const { return {tets_.data() + begin_[v], begin_[v + 1] - begin_[v]}; }

 private:
  static std::array<int, 2> two_least(const Tet& t) {
    const int a = std::min(t[0], t[1]), b = std::max(t[0], t[1]), c = std::min(t[2], t[3]), d = std::max(t[2], t[3]);
    return a < c ? std::array{a, std::min(b, c)} : std::array{c, std::min(a, d)};
  }
  std::vector<std::size_t> begin_;
  std::vector<int> tets_;
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

/// The faces whose least vertex is in first .. last - 1.
BlockFaces count_faces(const std::vector<Tet>& C, const TetsByVertex& table, int first, int last) {
  BlockFaces result;
  std::vector<FaceUse> uses;
  for (int v = first; v < last; ++v) {
    uses.clear();
    for (const int t : table[v]) add_faces(C[t], static_cast<std::size_t>(t), v, uses);
    std::sort(uses.begin(), uses.end(), [](const FaceUse& x, const FaceUse& y) { return x.rest < y.rest; });
    for (std::size_t i = 0, j = 0; i < uses.size(); i = j) {
      while (j < uses.size() && uses[j].rest == uses[i].rest) ++j;
      if (j - i == 1) result.single.push_back(static_cast<std::int64_t>(uses[i].source / 2));
      if (j - i == 2) result.n_same_side += uses[i].reversed() == uses[i + 1].reversed();
      if (j - i > 2) ++result.n_overused;
    }
  }
  return result;
}

}  // namespace

BoundaryFaces boundary_faces(const std::vector<Tet>& C, std::size_t n_vertices, const std::vector<char>* only) {
  detail::check_indices(C, n_vertices, "tet");
  const TetsByVertex table(C, n_vertices, only);
  const std::size_t n_blocks = (n_vertices + kVerticesPerBlock - 1) / kVerticesPerBlock;
  std::vector<BlockFaces> blocks(n_blocks);
  tbb::parallel_for(std::size_t{0}, n_blocks, [&](std::size_t b) {
    const auto first = static_cast<int>(b * kVerticesPerBlock);
    const auto last = static_cast<int>(std::min(n_vertices, (b + 1) * kVerticesPerBlock));
    blocks[b] = count_faces(C, table, first, last);
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
