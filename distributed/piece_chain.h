#pragma once

#include <mpi.h>

#include <cstddef>
#include <vector>

#include "distributed/unwinding.h"

namespace umtet {

/// Doubles that go from piece to piece in the order of an IdOrder: what is added to them is added in that order, as one
/// process does.
class PieceChain {
 public:
  /// Collective. All are 0 at first.
  PieceChain(MPI_Comm comm, std::size_t n_values);
  ~PieceChain();  ///< collective, unless something is thrown
  PieceChain(const PieceChain&) = delete;
  PieceChain& operator=(const PieceChain&) = delete;

  /// Adds what is in this rank's piece of a round: add(values). Each rank calls it once a round.
  template <class Add>
  void pass(const Add& add) {
    receive();
    add(values_);
    send();
  }
  /// What they have become. Collective, once, behind the last round.
  const std::vector<double>& end();

 private:
  void receive();
  void send();

  MPI_Comm comm_ = MPI_COMM_NULL;
  int rank_ = 0, n_ranks_ = 1;
  bool is_begun_ = false;  ///< of rank 0: it has passed them on
  std::vector<double> values_, sent_;
  MPI_Request request_ = MPI_REQUEST_NULL;
  const Unwinding unwinding_;
};

}  // namespace umtet
