#include "distributed/mesh/part_repair.h"

#include <algorithm>
#include <utility>

#include "distributed/exchange/collect.h"
#include "distributed/mesh/layer_window.h"
#include "mesh/classification/configuration_costs.h"

namespace umtet {
namespace {

/// A bad tet, with all data that is_bad() needs.
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

/// Returns the bad tets whose first corner is an own vertex, so that each tet of the whole layer is on one rank. Tets
/// with the same first corner keep their order. (The first corner is the least corner that moves.)
std::vector<SentTet> own_bad_tets(const LatticePart& part, ImplicitFunctionRef psi, const RepairParams& params,
                                  const BackgroundLayer& layer, const IdSet& inside, std::size_t& n_evaluations) {
  const auto& ids = layer.background_vertex;
  std::vector<SentTet> list;
  for (const BadTet& bad : bad_tets(layer, inside, psi, params.target + params.lift, n_evaluations)) {
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
  /// @param tets  bad tets of all ranks; tets with the same first corner are in the order of the whole layer
  GatheredLayer(BlocksAround blocks, std::vector<SentTet> tets, std::size_t n_tets)
      : blocks_(std::move(blocks)), n_tets_(n_tets) {
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
  std::vector<LayerVertex> around(std::int64_t vertex) override { return blocks_(vertex); }

 private:
  BlocksAround blocks_;
  std::vector<BadTet> bad_;
  std::vector<LayerVertex> corners_;
  std::size_t n_tets_;
};

}  // namespace

std::vector<std::pair<std::int64_t, Vec3>> places_of(const BackgroundLayer& layer) {
  std::vector<std::pair<std::int64_t, Vec3>> places;
  for (std::size_t v = 0; v < layer.layer.V.size(); ++v) {
    if (layer.layer.role[v] != ActiveLayer::Role::Fixed)
      places.emplace_back(layer.background_vertex[v], layer.layer.V[v]);
  }
  return places;
}

PartRepair repair_parts(MPI_Comm comm, const LatticePart& part, const Partition& partition, ImplicitFunctionRef psi,
                        const ClassificationParams& classification, const RepairParams& params,
                        const BackgroundLayer& layer, const IdSet& inside) {
  PartRepair made;
  if (params.max_tries == 0) return made;
  unsigned long long n_tets = 0, all_tets = 0;
  for (const Tet& t : layer.layer.C) n_tets += part.own().test(layer.background_vertex[t[0]]);
  MPI_Reduce(&n_tets, &all_tets, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM, 0, comm);
  std::vector<SentTet> bad = gathered(comm, own_bad_tets(part, psi, params, layer, inside, made.psi_evaluations));
  std::vector<Moved> moved;
  {
    LayerWindow window(comm, part, partition, inside, places_of(layer));
    if (rank_in(comm) == 0) {
      GatheredLayer remote({part.whole(), window, params.reach + 3}, std::move(bad), all_tets);
      IdSet states(part.whole().n_vertices());
      const RepairReport report =
          repair(part.whole(), *background_costs(part.whole())->links, psi, classification, params, remote, states);
      made.flipped = report.flipped;
      made.psi_evaluations += report.psi_evaluations;
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
