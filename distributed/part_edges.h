#pragma once

#include <mpi.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "distributed/distributed_mesh.h"
#include "distributed/owner_exchange.h"
#include "distributed/vertex_owners.h"
#include "mesh/certify/mid_side_numbers.h"

namespace umtet {

/// The edges of a mesh of all ranks between those who have tets with them and the one rank that owns each: that of its
/// lower vertex.
class PartEdges {
 public:
  /// Corners of an edge, ids in the background, the lower one first.
  using Ids = std::array<std::int64_t, 2>;

  /// Collective.
  PartEdges(MPI_Comm comm, const DistributedMesh& mesh, const VertexOwners& owners);

  /// Of edges of the own mesh, ascending as those of the whole do.
  const MidSideNumbers& number() const { return number_; }
  /// Of these, their vertices in the own mesh, the lower one first.
  const std::vector<std::array<int, 2>>& ends() const { return ends_; }
  /// Those that are owned, ascending.
  const std::vector<Ids>& owned() const { return owned_; }
  /// Of these, how many edges of all ranks are before each.
  const std::vector<std::int64_t>& global() const { return global_; }
  std::int64_t n_all() const { return n_all_; }  ///< of all ranks
  /// Between edges of the own mesh and places in owned().
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
