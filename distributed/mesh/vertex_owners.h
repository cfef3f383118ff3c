#pragma once

#include <mpi.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "distributed/exchange/owner_exchange.h"
#include "distributed/mesh/distributed_mesh.h"

namespace umtet {

/// Exchange of vertex data of a distributed mesh between the ranks with tets at a vertex and the one rank that owns it.
/// An owner need not have a tet at it.
class VertexOwners {
 public:
  /// Collective.
  VertexOwners(MPI_Comm comm, const DistributedMesh& mesh) : VertexOwners(comm, mesh, {}) {}

  /// Returns the background ids of the owned vertices, ascending.
  const std::vector<std::int64_t>& ids() const { return ids_; }
  std::size_t number(std::int64_t id) const {
    return static_cast<std::size_t>(std::lower_bound(ids_.begin(), ids_.end(), id) - ids_.begin());
  }
  /// Returns for each local vertex whether other ranks have tets at it.
  const std::vector<char>& shared() const { return shared_; }

  /// Exchange between local vertices and indices into ids().
  const OwnerExchange& exchange() const { return exchange_; }
  /// tell() and ask() of exchange(). Collective.
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
