#pragma once

#include <mpi.h>

#include <cstdint>
#include <vector>

#include "distributed/block_curve.h"
#include "mesh/core/implicit_function.h"

namespace umtet {

/// Which rank has which blocks: a rank has a piece of the curve.
class Partition {
 public:
  /// @param begins  where the piece of each rank begins, ascending, and at last the end of the curve
  explicit Partition(std::vector<std::uint64_t> begins) : begins_(std::move(begins)) {}
  int n_ranks() const { return static_cast<int>(begins_.size()) - 1; }
  std::uint64_t begin(int rank) const { return begins_[rank]; }
  std::uint64_t end(int rank) const { return begins_[rank + 1]; }
  int owner(const BlockCurve::Block& block) const;

 private:
  std::vector<std::uint64_t> begins_;
};

/// Pieces of about equal work. psi at the corners of a block says whether the boundary is in it, all of it is inside or
/// nothing is; what that misses costs balance and nothing else. Each rank looks at its share of the curve. The same for
/// the same number of ranks. Collective.
/// @param held  bytes that rank 0 holds besides its part, which is so much smaller (first_share()); read there
Partition balanced_partition(MPI_Comm comm, const BackgroundMesh& lattice, ImplicitFunctionRef psi, double held = 0);

}  // namespace umtet
