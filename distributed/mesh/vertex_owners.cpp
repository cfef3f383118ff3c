#include "distributed/mesh/vertex_owners.h"

#include <utility>

namespace umtet {
namespace {

using Lists = std::vector<std::vector<std::size_t>>;

/// @param ids      receives the ids, ascending
/// @param n_users  receives the number of ranks that have each
OwnerExchange exchange_of(MPI_Comm comm, const DistributedMesh& mesh, std::vector<std::int64_t>& ids,
                          std::vector<int>& n_users) {
  int n_ranks = 1;
  MPI_Comm_size(comm, &n_ranks);
  Lists asked(static_cast<std::size_t>(n_ranks)), wanted(asked.size());
  std::vector<std::vector<std::int64_t>> out(asked.size());
  for (std::size_t v = 0; v < mesh.owner.size(); ++v) {
    const auto r = static_cast<std::size_t>(mesh.owner[v]);
    asked[r].push_back(v);
    out[r].push_back(mesh.background_vertex[v]);
  }
  const auto in = all_to_all(comm, out);
  for (const auto& some : in) ids.insert(ids.end(), some.begin(), some.end());
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  n_users.assign(ids.size(), 0);
  for (std::size_t r = 0; r < in.size(); ++r) {
    for (const std::int64_t id : in[r]) {
      wanted[r].push_back(static_cast<std::size_t>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin()));
      ++n_users[wanted[r].back()];
    }
  }
  return {comm, mesh.owner.size(), ids.size(), std::move(asked), std::move(wanted)};
}

}  // namespace

VertexOwners::VertexOwners(MPI_Comm comm, const DistributedMesh& mesh, std::vector<int> n_users)
    : exchange_(exchange_of(comm, mesh, ids_, n_users)) {
  std::vector<char> is_shared;
  is_shared.reserve(n_users.size());
  for (const int n : n_users) is_shared.push_back(n > 1 ? 1 : 0);
  shared_ = tell(is_shared);
}

}  // namespace umtet
