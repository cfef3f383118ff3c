#pragma once

#include <mpi.h>

#include <vector>

#include "reconstruct/solve/multilevel_fit.h"

namespace umtet {

/// The other parts of a band, by MPI. Calls are collective.
class BandNeighbours final : public OtherParts {
 public:
  /// Collective. \throw std::length_error above 2^31 - 1 values between two ranks
  /// @param known  blocks of this part, by their numbers in the whole band, ascending
  /// @param begin  by cut_band()
  BandNeighbours(MPI_Comm comm, const std::vector<int>& known, const std::vector<int>& begin);

  /// From rank to rank, each of which goes on with the sum of those before: what one process adds up, to the bit.
  double sum(const std::vector<double>& of_blocks) override;
  void fill(float* values) override;

 private:
  /// Blocks between this rank and another, by their numbers in the part.
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
