#include "distributed/partition/lattice_part.h"

#include <algorithm>
#include <set>

namespace umtet {
namespace {

/// Calls f(block) for a block and all adjacent blocks.
template <class F>
void for_each_next_to(const BlockCurve::Block& b, const F& f) {
  for (std::int64_t k = -1; k <= 1; ++k) {
    for (std::int64_t j = -1; j <= 1; ++j) {
      for (std::int64_t i = -1; i <= 1; ++i) f(BlockCurve::Block{b[0] + i, b[1] + j, b[2] + k});
    }
  }
}

}  // namespace

LatticePart::LatticePart(const BackgroundMesh& whole, const Partition& partition, int rank)
    : whole_(whole), curve_(whole), rank_(rank), lattice_(whole) {
  list_blocks(partition);
  find_owners(partition);
  mark_vertices();
}

/// Finds the own blocks, and the box around them and their adjacent blocks.
void LatticePart::list_blocks(const Partition& partition) {
  BlockCurve::Block low = {}, high = {};
  for (std::uint64_t place = partition.begin(rank_); place < partition.end(rank_); ++place) {
    const BlockCurve::Block block = BlockCurve::block_at(place);
    if (!curve_.holds(block)) continue;
    for (int a = 0; a < 3; ++a) {
      low[a] = own_blocks_.empty() ? block[a] : std::min(low[a], block[a]);
      high[a] = own_blocks_.empty() ? block[a] : std::max(high[a], block[a]);
    }
    own_blocks_.push_back(block);
  }
  BackgroundMesh::Cell first = {}, n = {1, 1, 1};
  for (int a = 0; a < 3 && !own_blocks_.empty(); ++a) {
    // Colours of blocks alternate, so an even first block keeps the colours of the whole lattice. The box has one more
    // layer of blocks than is known, so that no known vertex is at the rim.
    first_block_[a] = std::max<std::int64_t>(0, low[a] - 2) / 2 * 2;
    const std::int64_t end = std::min(high[a] + 2, curve_.n()[a]);
    n_blocks_[a] = end - first_block_[a];
    first[a] = first_block_[a] * BlockCurve::kCells;
    n[a] = std::min(n_blocks_[a] * BlockCurve::kCells, whole_.n_cells()[a] - first[a]);
  }
  lattice_ = whole_.part(first, n);
  for (int a = 0; a < 3; ++a) n_blocks_[a] = (n[a] + 1) / BlockCurve::kCells + 1;
}

void LatticePart::find_owners(const Partition& partition) {
  owner_.assign(static_cast<std::size_t>(n_blocks_[0] * n_blocks_[1] * n_blocks_[2]), -1);
  knowers_.resize(owner_.size());
  const auto here = [&](const BlockCurve::Block& b) {
    return at({b[0] - first_block_[0], b[1] - first_block_[1], b[2] - first_block_[2]});
  };
  std::set<int> neighbours;
  std::vector<BlockCurve::Block> known;
  for (const BlockCurve::Block& own : own_blocks_) {
    for_each_next_to(own, [&](const BlockCurve::Block& b) {
      if (!curve_.holds(b) || owner_[here(b)] >= 0) return;
      owner_[here(b)] = partition.owner(b);
      known.push_back(b);
      if (owner_[here(b)] != rank_) neighbours.insert(owner_[here(b)]);
    });
  }
  neighbours_.assign(neighbours.begin(), neighbours.end());
  for (const BlockCurve::Block& block : known) {
    std::set<int> knowers;
    for_each_next_to(block, [&](const BlockCurve::Block& b) {
      if (!curve_.holds(b)) return;
      const int owner = partition.owner(b);
      // Ranks without a block next to an own block neither change data that this rank needs, nor need data from it.
      if (owner != rank_ && neighbours.count(owner) != 0) knowers.insert(owner);
    });
    knowers_[here(block)].assign(knowers.begin(), knowers.end());
  }
}

/// Marks the vertices of known blocks, except vertices on the rim of lattice(), from which an id step may lead out of
/// its ids.
void LatticePart::mark_vertices() {
  own_ = known_ = IdSet(lattice_.n_vertices());
  const auto &n = lattice_.n_cells(), &first = lattice_.first_cell(), &all = whole_.n_cells();
  for (std::int64_t k = -1; k <= n[2]; ++k) {
    for (std::int64_t j = -1; j <= n[1]; ++j) {
      for (std::int64_t i = -1; i <= n[0]; ++i) {
        const BackgroundMesh::Cell cell = {i, j, k};
        const int owner = owner_[at(BlockCurve::block_of(cell))];
        bool is_cut = owner < 0;
        for (int a = 0; a < 3; ++a)
          is_cut |= (cell[a] < 0 && first[a] > 0) || (cell[a] == n[a] && first[a] + n[a] < all[a]);
        if (is_cut) continue;
        for (int type = 0; type < lattice_.n_types(); ++type) {
          known_.insert(lattice_.vertex_id(type, cell));
          if (owner == rank_) own_.insert(lattice_.vertex_id(type, cell));
        }
      }
    }
  }
}

std::int64_t LatticePart::to_whole(std::int64_t v) const {
  return whole_.vertex_id(lattice_.type(v), sum(lattice_.cell(v), lattice_.first_cell()));
}

std::int64_t LatticePart::from_whole(std::int64_t v) const {
  BackgroundMesh::Cell cell = whole_.cell(v);
  for (int a = 0; a < 3; ++a) {
    cell[a] -= lattice_.first_cell()[a];
    if (cell[a] < -1 || cell[a] > lattice_.n_cells()[a]) return -1;
  }
  const std::int64_t here = lattice_.vertex_id(whole_.type(v), cell);
  return known_.test(here) ? here : -1;
}

}  // namespace umtet
