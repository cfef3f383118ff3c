#pragma once

#include <mpi.h>

#include <vector>

#include "reconstruct/solve/multilevel_fit.h"

namespace umtet {

/// Communication between parts of a band by MPI. All calls are collective.
class BandNeighbours final : public OtherParts {
 public:
  /// Collective.
  /// @param known  indices of the blocks of this part in the whole band, ascending
  /// @param begin  result of cut_band()
  /// \throw std::length_error above 2^31 - 1 values between two ranks
  BandNeighbours(MPI_Comm comm, const std::vector<int>& known, const std::vector<int>& begin);

  /// Passes the sum from rank to rank, each adding its values: the result equals the sum of one process to the bit.
  double sum(const std::vector<double>& of_blocks) override;
  void fill(float* values) override;

 private:
  /// Blocks shared with another rank, by index in the part.
  struct Neighbour {
    int rank;
    std::vector<int> sent, received;
    std::vector<float> out, in;
  };
  MPI_Comm comm_;
  int rank_ = 0, n_ranks_ = 1;
  std::vector<Neighbour> neighbours_;
};

}  // namespace umtet
