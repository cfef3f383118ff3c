#include "distributed/solver/ghost_tets.h"

#include <algorithm>
#include <set>

#include "distributed/exchange/all_to_all.h"
#include "distributed/exchange/collect.h"

namespace umtet {

std::vector<GhostTet> ghost_tets(MPI_Comm comm, const DistributedMesh& mesh, const SolverPart& part) {
  int n_ranks = 1;
  MPI_Comm_size(comm, &n_ranks);
  const Sharers& sharers = part.sharers;
  std::vector<int> place(mesh.owner.size(), -1);  // in sharers.vertex
  for (std::size_t k = 0; k < sharers.vertex.size(); ++k) place[sharers.vertex[k]] = static_cast<int>(k);
  std::vector<std::vector<GhostTet>> out(static_cast<std::size_t>(n_ranks));
  for (std::size_t t = 0; t < mesh.mesh.C.size(); ++t) {
    std::set<int> to;
    for (const int v : mesh.mesh.C[t]) {
      if (place[v] < 0) continue;
      const auto k = static_cast<std::size_t>(place[v]);
      for (std::size_t i = sharers.begin[k]; i < sharers.begin[k + 1]; ++i) to.insert(sharers.rank[i]);
    }
    if (to.empty()) continue;
    GhostTet ghost{part.global_tet[t], {}, {}, rank_in(comm)};
    for (std::size_t k = 0; k < 4; ++k) {
      const int v = mesh.mesh.C[t][k];
      ghost.corner[k] = part.global_vertex[v];
      std::copy_n(mesh.mesh.V[v].data(), 3, ghost.place[k]);
    }
    for (const int r : to) out[static_cast<std::size_t>(r)].push_back(ghost);
  }
  std::vector<GhostTet> ghosts;
  for (const auto& some : all_to_all(comm, out)) ghosts.insert(ghosts.end(), some.begin(), some.end());
  std::sort(ghosts.begin(), ghosts.end(), [](const GhostTet& a, const GhostTet& b) { return a.tet < b.tet; });
  return ghosts;
}

}  // namespace umtet
