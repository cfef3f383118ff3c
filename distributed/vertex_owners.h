#pragma once

#include <mpi.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "distributed/distributed_mesh.h"
#include "distributed/owner_exchange.h"

namespace umtet {

/// The vertices of a mesh between those who have tets with them and the one rank that owns each. An owner need not have
/// a tet with it.
class VertexOwners {
 public:
  /// Collective.
  VertexOwners(MPI_Comm comm, const DistributedMesh& mesh) : VertexOwners(comm, mesh, {}) {}

  /// Those that are owned, by ids in the background, ascending.
  const std::vector<std::int64_t>& ids() const { return ids_; }
  std::size_t number(std::int64_t id) const {
    return static_cast<std::size_t>(std::lower_bound(ids_.begin(), ids_.end(), id) - ids_.begin());
  }
  /// Of each vertex of the mesh whether ranks besides this one have tets with it.
  const std::vector<char>& shared() const { return shared_; }

  /// Between vertices of the mesh and places in ids().
  const OwnerExchange& exchange() const { return exchange_; }
  /// Its tell() and ask(). Collective.
  template <class T>
  std::vector<T> tell(const std::vector<T>& of_owned) const {
    return exchange_.tell(of_owned);
  }
  template <class Value, class Take>
  void ask(const Value& value, const Take& take) const {
    exchange_.ask(value, take);
  }

 private:
  VertexOwners(MPI_Comm comm, const DistributedMesh& mesh, std::vector<int> n_users);

  std::vector<std::int64_t> ids_;
  OwnerExchange exchange_;
  std::vector<char> shared_;
};

}  // namespace umtet
