#pragma once

#include <mpi.h>

#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "distributed/exchange/neighbourhood.h"
#include "distributed/exchange/unwinding.h"
#include "distributed/partition/lattice_part.h"
#include "distributed/partition/partition.h"
#include "mesh/base/id_set.h"
#include "mesh/fast/repair/repair.h"

namespace umtet {

/// States and positions of the vertices of all ranks, block by block, which any rank can read by MPI one-sided
/// communication.
class LayerWindow {
 public:
  using Places = std::vector<std::pair<std::int64_t, Vec3>>;

  /// Copies the data of own blocks. Collective. @param places  positions of own vertices off the background
  LayerWindow(MPI_Comm comm, const LatticePart& part, const Partition& partition, const IdSet& inside,
              const Places& places);
  ~LayerWindow();  ///< collective, unless an exception is propagating
  LayerWindow(const LayerWindow&) = delete;
  LayerWindow& operator=(const LayerWindow&) = delete;

  /// Returns the vertices of these blocks that are inside or off their background positions, with ids of the whole
  /// lattice. Not collective.
  std::vector<LayerVertex> get(const std::vector<BlockCurve::Block>& blocks);
  std::size_t n_gets() const { return n_gets_; }  ///< reads of other ranks
  std::size_t bytes() const { return bytes_; }    ///< bytes of these reads

 private:
  /// A vertex that moves.
  struct Entry {
    std::int64_t vertex;
    double place[3];
  };
  /// Words of the header of a block: the begin of its entries, their number, and a bit per vertex that is set for
  /// inside vertices, 64 cells per type.
  std::size_t n_words() const { return 2 + static_cast<std::size_t>(part_.whole().n_types()); }
  /// Memory of this rank that other ranks can read.
  template <class T>
  struct Open {
    MPI_Win window = MPI_WIN_NULL;  ///< MPI_WIN_NULL for a single rank
    std::vector<T> alone;           ///< the data of a single rank
    T* own = nullptr;
  };
  /// A range of a list on a rank.
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
  Open<std::uint64_t> headers_;  ///< headers by position on the piece of the curve of this rank
  Open<Entry> entries_;
  std::size_t n_gets_ = 0, bytes_ = 0;
  const Unwinding unwinding_;
};

/// Reader of the blocks around vertices of the whole lattice; it returns each block once.
class BlocksAround {
 public:
  /// @param edges  distance in edges around a vertex that the caller needs
  BlocksAround(const BackgroundMesh& whole, LayerWindow& window, int edges)
      : whole_(whole), window_(window), cells_((edges + 1) / 2) {}
  /// Returns all vertices within this distance of a vertex, and all other vertices in the same blocks, except for
  /// blocks that were returned before.
  std::vector<LayerVertex> operator()(std::int64_t vertex);
  /// Returns whether all vertices within this distance have been returned.
  bool has_given(std::int64_t vertex) const;

 private:
  template <class F>
  void for_each_block(std::int64_t vertex, const F& f) const;

  const BackgroundMesh& whole_;
  LayerWindow& window_;
  std::int64_t cells_;             ///< no edge of a lattice exceeds half a cell along an axis
  std::set<std::uint64_t> given_;  ///< positions of the returned blocks on the curve
};

}  // namespace umtet
