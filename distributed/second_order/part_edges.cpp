#include "distributed/second_order/part_edges.h"

#include <algorithm>
#include <utility>

#include "distributed/exchange/id_order.h"

namespace umtet {
namespace {

constexpr std::size_t kVerticesPerPiece = 1 << 16;  // half a megabyte

std::vector<std::array<int, 2>> ends_of(const std::vector<Tet>& C, const MidSideNumbers& number) {
  std::vector<std::array<int, 2>> ends(number.n_edges());
  for (const Tet& t : C) {
    for (const auto& [p, q] : kMidSideEdge) ends[number(t[p], t[q])] = {std::min(t[p], t[q]), std::max(t[p], t[q])};
  }
  return ends;
}

/// @param owned  receives the owned edges
OwnerExchange exchange_of(MPI_Comm comm, const DistributedMesh& mesh, const std::vector<std::array<int, 2>>& ends,
                          std::vector<PartEdges::Ids>& owned) {
  int n_ranks = 1;
  MPI_Comm_size(comm, &n_ranks);
  std::vector<std::vector<std::size_t>> asked(static_cast<std::size_t>(n_ranks)), wanted(asked.size());
  std::vector<std::vector<PartEdges::Ids>> out(asked.size());
  for (std::size_t e = 0; e < ends.size(); ++e) {
    const auto r = static_cast<std::size_t>(mesh.owner[ends[e][0]]);
    asked[r].push_back(e);
    out[r].push_back({mesh.background_vertex[ends[e][0]], mesh.background_vertex[ends[e][1]]});
  }
  const auto in = all_to_all(comm, out);
  for (const auto& some : in) owned.insert(owned.end(), some.begin(), some.end());
  std::sort(owned.begin(), owned.end());
  owned.erase(std::unique(owned.begin(), owned.end()), owned.end());
  for (std::size_t r = 0; r < in.size(); ++r) {
    for (const PartEdges::Ids& edge : in[r])
      wanted[r].push_back(static_cast<std::size_t>(std::lower_bound(owned.begin(), owned.end(), edge) - owned.begin()));
  }
  return {comm, ends.size(), owned.size(), std::move(asked), std::move(wanted)};
}

}  // namespace

PartEdges::PartEdges(MPI_Comm comm, const DistributedMesh& mesh, const VertexOwners& owners)
    : number_(mesh.mesh.C, mesh.mesh.V.size()),
      ends_(ends_of(mesh.mesh.C, number_)),
      exchange_(exchange_of(comm, mesh, ends_, owned_)) {
  std::vector<std::int64_t> n_of_vertex(owners.ids().size(), 0);
  for (const Ids& edge : owned_) ++n_of_vertex[owners.number(edge[0])];
  const std::vector<std::int64_t> first = IdOrder(comm, owners.ids(), kVerticesPerPiece).sums_before(n_of_vertex);
  std::int64_t k = 0;
  for (std::size_t e = 0; e < owned_.size(); ++e) {
    k = e > 0 && owned_[e][0] == owned_[e - 1][0] ? k + 1 : 0;
    global_.push_back(first[owners.number(owned_[e][0])] + k);
  }
  n_all_ = static_cast<std::int64_t>(owned_.size());
  MPI_Allreduce(MPI_IN_PLACE, &n_all_, 1, MPI_INT64_T, MPI_SUM, comm);
}

}  // namespace umtet
