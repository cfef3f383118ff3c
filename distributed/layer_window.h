#pragma once

#include <mpi.h>

#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "distributed/lattice_part.h"
#include "distributed/neighbourhood.h"
#include "distributed/partition.h"
#include "distributed/unwinding.h"
#include "mesh/base/id_set.h"
#include "mesh/fast/repair.h"

namespace umtet {

/// States and places of the vertices of all ranks, block by block, open to any of them by MPI's one-sided access.
class LayerWindow {
 public:
  using Places = std::vector<std::pair<std::int64_t, Vec3>>;

  /// Collective; copies what own blocks hold. @param places  of own vertices that are not where the background has them
  LayerWindow(MPI_Comm comm, const LatticePart& part, const Partition& partition, const IdSet& inside,
              const Places& places);
  ~LayerWindow();  ///< collective, unless something is thrown
  LayerWindow(const LayerWindow&) = delete;
  LayerWindow& operator=(const LayerWindow&) = delete;

  /// The vertices of these blocks that are inside or not where the background has them, by ids of the whole. Not
  /// collective.
  std::vector<LayerVertex> get(const std::vector<BlockCurve::Block>& blocks);
  std::size_t n_gets() const { return n_gets_; }  ///< of other ranks
  std::size_t bytes() const { return bytes_; }    ///< in these

 private:
  /// A vertex that moves.
  struct Entry {
    std::int64_t vertex;
    double place[3];
  };
  /// Words of the header of a block: where its entries begin, how many they are, and a bit for each vertex that is
  /// inside, 64 cells for each type.
  std::size_t n_words() const { return 2 + static_cast<std::size_t>(part_.whole().n_types()); }
  /// Memory of this rank that others may read.
  template <class T>
  struct Open {
    MPI_Win window = MPI_WIN_NULL;  ///< none for a single rank
    std::vector<T> alone;           ///< then it is here
    T* own = nullptr;
  };
  /// A part of a list that a rank has.
  struct Piece {
    int rank;
    std::size_t first, n;
  };
  void list_own(const IdSet& inside, const Places& places, std::vector<std::uint64_t>& headers,
                std::vector<Entry>& entries) const;
  template <class T>
  Open<T> opened(std::vector<T> list) const;
  template <class T>
  void close(Open<T>& open) const;
  template <class T>
  std::vector<T> read(const Open<T>& open, const std::vector<Piece>& pieces);
  void add(const BlockCurve::Block& block, const std::uint64_t* header, const Entry* entries,
           std::vector<LayerVertex>& list) const;

  MPI_Comm comm_;
  const LatticePart& part_;
  const Partition& partition_;
  const int rank_;
  Open<std::uint64_t> headers_;  ///< by place on the own piece of the curve
  Open<Entry> entries_;
  std::size_t n_gets_ = 0, bytes_ = 0;
  const Unwinding unwinding_;
};

/// What is around vertices of the whole lattice, each block once.
class BlocksAround {
 public:
  /// @param edges  that a reader looks around a vertex
  BlocksAround(const BackgroundMesh& whole, LayerWindow& window, int edges)
      : whole_(whole), window_(window), cells_((edges + 1) / 2) {}
  /// All within so many edges of a vertex, and what else is in the blocks, but for blocks that were given before.
  std::vector<LayerVertex> operator()(std::int64_t vertex);
  /// All within so many edges of it has been given.
  bool has_given(std::int64_t vertex) const;

 private:
  template <class F>
  void for_each_block(std::int64_t vertex, const F& f) const;

  const BackgroundMesh& whole_;
  LayerWindow& window_;
  std::int64_t cells_;             ///< no edge of a lattice is longer than half a cell along an axis
  std::set<std::uint64_t> given_;  ///< places of blocks
};

}  // namespace umtet
