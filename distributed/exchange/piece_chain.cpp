#include "distributed/exchange/piece_chain.h"

namespace umtet {

PieceChain::PieceChain(MPI_Comm comm, std::size_t n_values) : values_(n_values, 0) {
  MPI_Comm_dup(comm, &comm_);
  MPI_Comm_rank(comm_, &rank_);
  MPI_Comm_size(comm_, &n_ranks_);
}

PieceChain::~PieceChain() {
  if (!unwinding_) MPI_Comm_free(&comm_);
}

void PieceChain::receive() {
  if (n_ranks_ == 1 || (rank_ == 0 && !is_begun_)) return;
  MPI_Recv(values_.data(), static_cast<int>(values_.size()), MPI_DOUBLE, (rank_ + n_ranks_ - 1) % n_ranks_, 0, comm_,
           MPI_STATUS_IGNORE);
}

void PieceChain::send() {
  is_begun_ = true;
  if (n_ranks_ == 1) return;
  // The wait comes later, because the next rank may be in a collective call of the next round.
  MPI_Wait(&request_, MPI_STATUS_IGNORE);
  sent_ = values_;
  MPI_Isend(sent_.data(), static_cast<int>(sent_.size()), MPI_DOUBLE, (rank_ + 1) % n_ranks_, 0, comm_, &request_);
}

const std::vector<double>& PieceChain::end() {
  if (rank_ == 0) receive();
  MPI_Wait(&request_, MPI_STATUS_IGNORE);
  MPI_Bcast(values_.data(), static_cast<int>(values_.size()), MPI_DOUBLE, 0, comm_);
  return values_;
}

}  // namespace umtet
