#include "distributed/program/shared_level_set.h"

#include <cstdint>
#include <utility>
#include <vector>

#include "distributed/exchange/collect.h"
#include "distributed/exchange/phase.h"

namespace umtet {
namespace {

/// The data of a level set except blocks and coefficients.
struct Head {
  std::int64_t n_levels, kind, support, n[3];
  double gamma, epsilon, origin[3], h;
};

Head head_of(const LevelSet& psi) {
  const LmePrior& prior = psi.prior();
  const Lattice& L = psi.coarsest().lattice;
  return {psi.n_levels(),
          static_cast<std::int64_t>(prior.kind),
          prior.support,
          {L.n[0], L.n[1], L.n[2]},
          prior.gamma,
          prior.epsilon,
          {L.origin[0], L.origin[1], L.origin[2]},
          L.h};
}

}  // namespace

LevelSet shared_level_set(MPI_Comm comm, const std::optional<LevelSet>& own) {
  begin_phase("share_psi");
  const bool has = rank_in(comm) == 0;
  Head head{};
  if (has) head = head_of(*own);
  MPI_Bcast(&head, sizeof head, MPI_BYTE, 0, comm);
  LevelSetLevel coarsest{{Vec3(head.origin), head.h, {}}, {}};
  for (int a = 0; a < 3; ++a) coarsest.lattice.n[a] = static_cast<int>(head.n[a]);
  broadcast(comm, has ? own->coarsest().coefficients : coarsest.coefficients, coarsest.coefficients);
  const LmePrior prior{static_cast<LmePrior::Kind>(head.kind), head.gamma, static_cast<int>(head.support),
                       head.epsilon};
  Lattice lattice = coarsest.lattice;
  std::vector<LevelSetBand> bands;
  for (int level = 1; level < head.n_levels; ++level) {
    lattice.h /= 2;
    lattice.n = (2 * (lattice.n.array() - 1) + 1).matrix();
    std::vector<Eigen::Vector3i> blocks;
    std::vector<float> coefficients;
    broadcast(comm, has ? own->band(level).blocks.blocks() : blocks, blocks);
    broadcast(comm, has ? own->band(level).coefficients : coefficients, coefficients);
    if (!has) bands.push_back({LatticeBlocks(lattice, half_width(prior), std::move(blocks)), std::move(coefficients)});
  }
  return has ? *own : LevelSet(prior, std::move(coarsest), std::move(bands));
}

}  // namespace umtet
