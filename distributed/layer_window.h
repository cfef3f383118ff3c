#pragma once

#include <mpi.h>

#include <cstdint>
#include <vector>

#include "distributed/lattice_part.h"
#include "distributed/neighbourhood.h"
#include "distributed/partition.h"
#include "mesh/base/id_set.h"
#include "mesh/fast/repair.h"
#include "mesh/submesh/linked_active_layer.h"

namespace umtet {

/// States and places of the vertices of all ranks, block by block, open to any of them by MPI's one-sided access.
class LayerWindow {
 public:
  /// Collective; copies what own blocks hold. @param layer  of own vertices
  LayerWindow(MPI_Comm comm, const LatticePart& part, const Partition& partition, const IdSet& inside,
              const BackgroundLayer& layer);
  ~LayerWindow();  ///< collective
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
  void list_own(const IdSet& inside, const BackgroundLayer& layer, std::vector<std::uint64_t>& headers,
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
};

}  // namespace umtet
