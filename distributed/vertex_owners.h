#pragma once

#include <mpi.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "distributed/all_to_all.h"
#include "distributed/distributed_mesh.h"

namespace umtet {

/// The vertices of a mesh between those who have tets with them and the one rank that owns each. An owner need not have
/// a tet with it.
class VertexOwners {
 public:
  /// Collective.
  VertexOwners(MPI_Comm comm, const DistributedMesh& mesh);

  /// Those that are owned, by ids in the background, ascending.
  const std::vector<std::int64_t>& ids() const { return ids_; }
  std::size_t number(std::int64_t id) const {
    return static_cast<std::size_t>(std::lower_bound(ids_.begin(), ids_.end(), id) - ids_.begin());
  }
  /// Of each vertex of the mesh whether ranks besides this one have tets with it.
  const std::vector<char>& shared() const { return shared_; }

  /// What owners know of vertices, for all who have them. Collective.
  /// @param of_owned  by place in ids()
  /// @return by vertex of the mesh
  template <class T>
  std::vector<T> tell(const std::vector<T>& of_owned) const {
    std::vector<std::vector<T>> out(wanted_.size());
    for (std::size_t r = 0; r < out.size(); ++r)
      for (const std::size_t k : wanted_[r]) out[r].push_back(of_owned[k]);
    std::vector<T> told(n_vertices_);
    const auto in = all_to_all(comm_, out);
    for (std::size_t r = 0; r < in.size(); ++r)
      for (std::size_t k = 0; k < in[r].size(); ++k) told[asked_[r][k]] = in[r][k];
    return told;
  }
  /// What all who have vertices know of them, for owners: take(place in ids(), value), once for each who has it.
  /// Collective.
  /// @param value  of a vertex of the mesh, without pointers
  template <class Value, class Take>
  void ask(const Value& value, const Take& take) const {
    using T = decltype(value(std::size_t{0}));
    std::vector<std::vector<T>> out(asked_.size());
    for (std::size_t r = 0; r < out.size(); ++r)
      for (const std::size_t v : asked_[r]) out[r].push_back(value(v));
    const auto in = all_to_all(comm_, out);
    for (std::size_t r = 0; r < in.size(); ++r)
      for (std::size_t k = 0; k < in[r].size(); ++k) take(wanted_[r][k], in[r][k]);
  }

 private:
  MPI_Comm comm_;
  std::size_t n_vertices_;
  std::vector<std::int64_t> ids_;
  std::vector<std::vector<std::size_t>> asked_;   ///< by rank: vertices of the mesh that it owns
  std::vector<std::vector<std::size_t>> wanted_;  ///< by rank: places in ids() of what it has
  std::vector<char> shared_;
};

}  // namespace umtet
