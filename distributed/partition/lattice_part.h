#pragma once

#include <cstdint>
#include <vector>

#include "distributed/partition/block_curve.h"
#include "distributed/partition/partition.h"
#include "mesh/background/background_mesh.h"
#include "mesh/base/id_set.h"

namespace umtet {

/// The part of a lattice on a rank: the known blocks, which are its own blocks and adjacent blocks. A block is four
/// cells wide and an edge at most half a cell along an axis, so eight rings around an own vertex are known.
///
/// Ids are those of lattice(), a box of cells around all known blocks, unless stated otherwise. They ascend in the
/// order of the whole lattice.
class LatticePart {
 public:
  LatticePart(const BackgroundMesh& whole, const Partition& partition, int rank);

  const BackgroundMesh& whole() const { return whole_; }
  const BackgroundMesh& lattice() const { return lattice_; }
  std::int64_t to_whole(std::int64_t v) const;
  /// Returns the id in lattice(); -1 for a vertex that is not known.
  std::int64_t from_whole(std::int64_t v) const;

  const IdSet& own() const { return own_; }      ///< own vertices
  const IdSet& known() const { return known_; }  ///< known vertices, including own vertices
  /// Returns the rank that owns a vertex. \pre the vertex is known
  int owner(std::int64_t v) const { return owner_[at(v)]; }
  /// Returns the other ranks that know a vertex, ascending. \pre the vertex is known
  const std::vector<int>& knowers(std::int64_t v) const { return knowers_[at(v)]; }
  /// Ranks with a block next to an own block, ascending.
  const std::vector<int>& neighbours() const { return neighbours_; }

  /// Calls f(cell, number in the whole lattice) for the cells of tets in own blocks, ascending.
  template <class F>
  void for_each_own_cell(const F& f) const {
    const auto &n = lattice_.n_cells(), &first = lattice_.first_cell(), &all = whole_.n_cells();
    for (std::int64_t k = 0; k < n[2]; ++k) {
      for (std::int64_t j = 0; j < n[1]; ++j) {
        for (std::int64_t i = 0; i < n[0]; ++i) {
          if (owner_[at(BlockCurve::block_of({i, j, k}))] != rank_) continue;
          f(BackgroundMesh::Cell{i, j, k}, i + first[0] + all[0] * (j + first[1] + all[1] * (k + first[2])));
        }
      }
    }
  }

 private:
  static BackgroundMesh::Cell sum(const BackgroundMesh::Cell& a, const BackgroundMesh::Cell& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
  }
  /// Returns the index of a block in lattice(), whose first block is a block of the whole lattice.
  std::size_t at(const BlockCurve::Block& b) const {
    return static_cast<std::size_t>(b[0] + n_blocks_[0] * (b[1] + n_blocks_[1] * b[2]));
  }
  std::size_t at(std::int64_t v) const { return at(BlockCurve::block_of(lattice_.cell(v))); }
  void list_blocks(const Partition& partition);
  void find_owners(const Partition& partition);
  void mark_vertices();

  const BackgroundMesh& whole_;
  const BlockCurve curve_;
  const int rank_;
  std::vector<BlockCurve::Block> own_blocks_;  ///< indices in the whole lattice
  BlockCurve::Block first_block_ = {};         ///< first block of lattice(), in the whole lattice
  BlockCurve::Block n_blocks_ = {1, 1, 1};
  BackgroundMesh lattice_;
  std::vector<int> owner_;                 ///< by block of lattice(); -1 for blocks that are not known
  std::vector<std::vector<int>> knowers_;  ///< by block of lattice()
  std::vector<int> neighbours_;
  IdSet own_{0}, known_{0};
};

}  // namespace umtet
