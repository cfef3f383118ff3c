#include "distributed/vertex_owners.h"

namespace umtet {

VertexOwners::VertexOwners(MPI_Comm comm, const DistributedMesh& mesh) : comm_(comm), n_vertices_(mesh.owner.size()) {
  int n_ranks = 1;
  MPI_Comm_size(comm, &n_ranks);
  asked_.resize(static_cast<std::size_t>(n_ranks));
  wanted_.resize(asked_.size());
  std::vector<std::vector<std::int64_t>> out(asked_.size());
  for (std::size_t v = 0; v < n_vertices_; ++v) {
    const auto r = static_cast<std::size_t>(mesh.owner[v]);
    asked_[r].push_back(v);
    out[r].push_back(mesh.background_vertex[v]);
  }
  const auto in = all_to_all(comm, out);
  for (const auto& some : in) ids_.insert(ids_.end(), some.begin(), some.end());
  std::sort(ids_.begin(), ids_.end());
  ids_.erase(std::unique(ids_.begin(), ids_.end()), ids_.end());
  std::vector<int> n_users(ids_.size(), 0);
  for (std::size_t r = 0; r < in.size(); ++r) {
    for (const std::int64_t id : in[r]) {
      wanted_[r].push_back(number(id));
      ++n_users[wanted_[r].back()];
    }
  }
  std::vector<char> is_shared;
  for (const int n : n_users) is_shared.push_back(n > 1 ? 1 : 0);
  shared_ = tell(is_shared);
}

}  // namespace umtet
