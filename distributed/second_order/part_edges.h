#pragma once

#include <mpi.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "distributed/exchange/owner_exchange.h"
#include "distributed/mesh/distributed_mesh.h"
#include "distributed/mesh/vertex_owners.h"
#include "mesh/second_order/mid_side_numbers.h"

namespace umtet {

/// Exchange of edge data of a distributed mesh between the ranks with tets at an edge and the one rank that owns it,
/// the owner of its lower vertex.
class PartEdges {
 public:
  /// Corners of an edge as ids in the background, the lower one first.
  using Ids = std::array<std::int64_t, 2>;

  /// Collective.
  PartEdges(MPI_Comm comm, const DistributedMesh& mesh, const VertexOwners& owners);

  /// Returns the numbering of the local edges; the order is that of the whole mesh.
  const MidSideNumbers& number() const { return number_; }
  /// Returns the local vertices of each edge, the lower one first.
  const std::vector<std::array<int, 2>>& ends() const { return ends_; }
  /// The owned edges, ascending.
  const std::vector<Ids>& owned() const { return owned_; }
  /// Returns for each owned edge the number of edges before it in the whole mesh.
  const std::vector<std::int64_t>& global() const { return global_; }
  std::int64_t n_all() const { return n_all_; }  ///< number of edges on all ranks
  /// Exchange between local edges and indices into owned().
  const OwnerExchange& exchange() const { return exchange_; }

 private:
  MidSideNumbers number_;
  std::vector<std::array<int, 2>> ends_;
  std::vector<Ids> owned_;
  OwnerExchange exchange_;
  std::vector<std::int64_t> global_;
  std::int64_t n_all_ = 0;
};

}  // namespace umtet
