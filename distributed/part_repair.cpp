#include "distributed/part_repair.h"

#include <algorithm>
#include <set>

#include "distributed/layer_window.h"
#include "mesh/classification/configuration_costs.h"

namespace umtet {
namespace {

int rank_in(MPI_Comm comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

/// What all ranks have, in their order; on rank 0. T has no pointers.
template <class T>
std::vector<T> gathered(MPI_Comm comm, const std::vector<T>& own) {
  int n_ranks = 1, n = static_cast<int>(own.size() * sizeof(T)), all = 0;
  MPI_Comm_size(comm, &n_ranks);
  std::vector<int> counts(static_cast<std::size_t>(n_ranks), 0), begins;
  MPI_Gather(&n, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, comm);
  for (const int c : counts) {
    begins.push_back(all);
    all += c;
  }
  std::vector<T> result(static_cast<std::size_t>(all) / sizeof(T));
  MPI_Gatherv(own.data(), n, MPI_BYTE, result.data(), counts.data(), begins.data(), MPI_BYTE, 0, comm);
  return result;
}

/// What rank 0 has becomes what all have. T has no pointers.
template <class T>
void broadcast(MPI_Comm comm, std::vector<T>& list) {
  int n = static_cast<int>(list.size());
  MPI_Bcast(&n, 1, MPI_INT, 0, comm);
  list.resize(static_cast<std::size_t>(n));
  MPI_Bcast(list.data(), static_cast<int>(list.size() * sizeof(T)), MPI_BYTE, 0, comm);
}

/// A bad tet with all that is_bad() asks of it.
struct SentTet {
  double badness;
  std::int64_t corner[4];
  double place[4][3];
  std::uint8_t is_inside[4];
};

struct Moved {
  std::int64_t vertex;
  double place[3];
};

/// Of the tets whose first corner is own: each tet of the whole layer is of one rank, and those with one first corner
/// are in their order. (The first is the least that moves.)
std::vector<SentTet> own_bad_tets(const LatticePart& part, ImplicitFunctionRef psi, const RepairParams& params,
                                  const BackgroundLayer& layer, const IdSet& inside) {
  std::size_t n_evaluations = 0;
  const auto& ids = layer.background_vertex;
  std::vector<SentTet> list;
  for (const BadTet& bad : bad_tets(layer, inside, psi, params, n_evaluations)) {
    if (!part.own().test(bad.tet[0])) continue;
    SentTet sent{};
    sent.badness = bad.badness;
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec3& x = layer.layer.V[std::lower_bound(ids.begin(), ids.end(), bad.tet[k]) - ids.begin()];
      sent.corner[k] = part.to_whole(bad.tet[k]);
      sent.is_inside[k] = inside.test(bad.tet[k]);
      std::copy_n(x.data(), 3, sent.place[k]);
    }
    list.push_back(sent);
  }
  return list;
}

class GatheredLayer final : public RemoteLayer {
 public:
  /// @param tets  of all ranks, those of one first corner in their order
  GatheredLayer(const BackgroundMesh& whole, LayerWindow& window, std::vector<SentTet> tets, std::size_t n_tets)
      : whole_(whole), curve_(whole), window_(window), n_tets_(n_tets) {
    std::stable_sort(tets.begin(), tets.end(),
                     [](const SentTet& a, const SentTet& b) { return a.corner[0] < b.corner[0]; });
    for (const SentTet& t : tets) {
      bad_.push_back({t.badness, {t.corner[0], t.corner[1], t.corner[2], t.corner[3]}});
      for (std::size_t k = 0; k < 4; ++k)
        corners_.push_back({t.corner[k], t.is_inside[k] != 0, Vec3(t.place[k][0], t.place[k][1], t.place[k][2])});
    }
  }
  const std::vector<BadTet>& bad() const override { return bad_; }
  const std::vector<LayerVertex>& corners() const override { return corners_; }
  std::size_t n_tets() const override { return n_tets_; }
  std::vector<LayerVertex> around(std::int64_t vertex) override;
  /// Edges of a lattice are at most half a cell long along an axis.
  void reach(int edges) { cells_ = (edges + 1) / 2; }

 private:
  const BackgroundMesh& whole_;
  const BlockCurve curve_;
  LayerWindow& window_;
  std::vector<BadTet> bad_;
  std::vector<LayerVertex> corners_;
  std::size_t n_tets_;
  std::int64_t cells_ = 0;
  std::set<std::uint64_t> given_;  ///< places of blocks
};

std::vector<LayerVertex> GatheredLayer::around(std::int64_t vertex) {
  const BackgroundMesh::Cell cell = whole_.cell(vertex);
  BackgroundMesh::Cell low = cell, high = cell;
  for (int a = 0; a < 3; ++a) {
    low[a] = std::max<std::int64_t>(-1, cell[a] - cells_);
    high[a] = std::min(whole_.n_cells()[a], cell[a] + cells_);
  }
  const BlockCurve::Block first = BlockCurve::block_of(low), last = BlockCurve::block_of(high);
  std::vector<BlockCurve::Block> blocks;
  for (std::int64_t k = first[2]; k <= last[2]; ++k) {
    for (std::int64_t j = first[1]; j <= last[1]; ++j) {
      for (std::int64_t i = first[0]; i <= last[0]; ++i) {
        if (given_.insert(BlockCurve::place({i, j, k})).second) blocks.push_back({i, j, k});
      }
    }
  }
  return window_.get(blocks);
}

}  // namespace

PartRepair repair_parts(MPI_Comm comm, const LatticePart& part, const Partition& partition, ImplicitFunctionRef psi,
                        const ClassificationParams& classification, const RepairParams& params,
                        const BackgroundLayer& layer, const IdSet& inside) {
  PartRepair made;
  if (params.max_tries == 0) return made;
  unsigned long long n_tets = 0, all_tets = 0;
  for (const Tet& t : layer.layer.C) n_tets += part.own().test(layer.background_vertex[t[0]]);
  MPI_Reduce(&n_tets, &all_tets, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM, 0, comm);
  std::vector<SentTet> bad = gathered(comm, own_bad_tets(part, psi, params, layer, inside));
  std::vector<Moved> moved;
  {
    LayerWindow window(comm, part, partition, inside, layer);
    if (rank_in(comm) == 0) {
      GatheredLayer remote(part.whole(), window, std::move(bad), all_tets);
      remote.reach(params.reach + 3);
      IdSet states(part.whole().n_vertices());
      const RepairReport report =
          repair(part.whole(), *background_costs(part.whole())->links, psi, classification, params, remote, states);
      made.flipped = report.flipped;
      for (const auto& [v, x] : report.moved) moved.push_back({v, {x[0], x[1], x[2]}});
      made.n_gets = window.n_gets();
      made.bytes = window.bytes();
    }
    MPI_Barrier(comm);  // windows are open until rank 0 has done
  }
  broadcast(comm, made.flipped);
  broadcast(comm, moved);
  for (const Moved& m : moved) made.moved.emplace_back(m.vertex, Vec3(m.place[0], m.place[1], m.place[2]));
  return made;
}

}  // namespace umtet
