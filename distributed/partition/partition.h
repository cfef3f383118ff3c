#pragma once

#include <mpi.h>

#include <cstdint>
#include <vector>

#include "distributed/partition/block_curve.h"
#include "mesh/core/implicit_function.h"

namespace umtet {

/// Partition of the blocks among ranks: each rank has a piece of the Morton curve.
class Partition {
 public:
  /// @param begins  begin of each rank's piece, ascending, and the end of the curve
  explicit Partition(std::vector<std::uint64_t> begins) : begins_(std::move(begins)) {}
  int n_ranks() const { return static_cast<int>(begins_.size()) - 1; }
  std::uint64_t begin(int rank) const { return begins_[rank]; }
  std::uint64_t end(int rank) const { return begins_[rank + 1]; }
  int owner(const BlockCurve::Block& block) const;

 private:
  std::vector<std::uint64_t> begins_;
};

/// Partition into pieces of about equal work. psi at the corners of a block indicates whether the block contains the
/// boundary, is inside, or is outside; errors of this test affect only the balance. Each rank evaluates its share of
/// the curve. The result is the same for the same number of ranks. Collective.
/// @param held  bytes that rank 0 holds for other purposes, which reduce its share (first_share()); used on rank 0 only
Partition balanced_partition(MPI_Comm comm, const BackgroundMesh& lattice, ImplicitFunctionRef psi, double held = 0);

}  // namespace umtet
