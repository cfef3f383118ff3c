#include "distributed/mesh/part_manifold.h"

#include <algorithm>
#include <memory>

#include "distributed/exchange/collect.h"
#include "distributed/mesh/layer_window.h"
#include "mesh/classification/configuration_costs.h"
#include "mesh/classification/manifold_boundary.h"

namespace umtet {
namespace {

/// A flip in a message to another rank.
struct SentFlip {
  std::int64_t vertex;
  std::int64_t is_filled;
  double distance;
};

}  // namespace

std::vector<ManifoldFlip> make_parts_manifold(MPI_Comm comm, const LatticePart& part, const Partition& partition,
                                              ImplicitFunctionRef psi, const ClassificationParams& params,
                                              const std::vector<std::int64_t>& bad, IdSet& inside,
                                              std::size_t& n_psi_evaluations) {
  std::vector<std::int64_t> all;
  for (const std::int64_t v : bad) all.push_back(part.to_whole(v));
  all = gathered(comm, all);
  broadcast(comm, all);
  if (all.empty()) return {};
  std::sort(all.begin(), all.end());
  std::vector<SentFlip> flips;
  {
    LayerWindow window(comm, part, partition, inside, {});
    if (rank_in(comm) == 0) {
      BlocksAround blocks(part.whole(), window, kManifoldReach);
      IdSet states(part.whole().n_vertices());
      const auto read = [&](std::int64_t v) {
        for (const LayerVertex& w : blocks(v)) states.insert(w.vertex);
      };
      const auto costs = background_costs(part.whole());
      const ManifoldReport report =
          make_manifold(part.whole(), costs->links.get(), psi, params, false, all, states, {}, read);
      n_psi_evaluations += report.psi_evaluations;
      for (const ManifoldFlip& f : report.flips) flips.push_back({f.background_vertex, f.is_filled, f.distance});
    }
    MPI_Barrier(comm);  // the window is open until rank 0 has done
  }
  broadcast(comm, flips);
  std::vector<ManifoldFlip> made;
  for (const SentFlip& f : flips) {
    made.push_back({f.vertex, part.whole().position(f.vertex), f.is_filled != 0, f.distance});
    const std::int64_t v = part.from_whole(f.vertex);
    if (v >= 0) f.is_filled != 0 ? inside.insert(v) : inside.erase(v);
  }
  return made;
}

}  // namespace umtet
