#pragma once

#include <mpi.h>

#include <cstddef>
#include <vector>

#include "distributed/exchange/unwinding.h"

namespace umtet {

/// Ordered sum: doubles that are passed from piece to piece in the order of an IdOrder. Contributions are added in this
/// order, as in one process.
class PieceChain {
 public:
  /// Starts with zeros. Collective.
  PieceChain(MPI_Comm comm, std::size_t n_values);
  ~PieceChain();  ///< collective, unless an exception is propagating
  PieceChain(const PieceChain&) = delete;
  PieceChain& operator=(const PieceChain&) = delete;

  /// Adds the contributions of this rank's piece of a round by add(values). Each rank calls it once per round.
  template <class Add>
  void pass(const Add& add) {
    receive();
    add(values_);
    send();
  }
  /// Returns the final values. Collective; to be called once, after the last round.
  const std::vector<double>& end();

 private:
  void receive();
  void send();

  MPI_Comm comm_ = MPI_COMM_NULL;
  int rank_ = 0, n_ranks_ = 1;
  bool is_begun_ = false;  ///< on rank 0: the values have been passed on
  std::vector<double> values_, sent_;
  MPI_Request request_ = MPI_REQUEST_NULL;
  const Unwinding unwinding_;
};

}  // namespace umtet
