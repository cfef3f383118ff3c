#include "distributed/fit/band_neighbours.h"

#include <algorithm>

#include "distributed/exchange/all_to_all.h"
#include "distributed/exchange/mpi_count.h"
#include "distributed/fit/band_cut.h"

namespace umtet {
namespace {

constexpr std::size_t kNodes = LatticeBlocks::kNodes;

}  // namespace

BandNeighbours::BandNeighbours(MPI_Comm comm, const std::vector<int>& known, const std::vector<int>& begin)
    : comm_(comm) {
  MPI_Comm_rank(comm, &rank_);
  MPI_Comm_size(comm, &n_ranks_);
  std::vector<std::vector<int>> wanted(static_cast<std::size_t>(n_ranks_));
  for (const int b : known) {
    const int owner = rank_of_block(begin, b);
    if (owner != rank_) wanted[static_cast<std::size_t>(owner)].push_back(b);
  }
  const std::vector<std::vector<int>> asked = all_to_all(comm, wanted);
  const auto numbers = [&](const std::vector<int>& blocks) {
    std::vector<int> at;
    for (const int b : blocks)
      at.push_back(static_cast<int>(std::lower_bound(known.begin(), known.end(), b) - known.begin()));
    return at;
  };
  for (int r = 0; r < n_ranks_; ++r) {
    const auto &in = wanted[static_cast<std::size_t>(r)], &out = asked[static_cast<std::size_t>(r)];
    if (in.empty() && out.empty()) continue;
    neighbours_.push_back({r, numbers(out), numbers(in), {}, {}});
    for (const std::size_t n : {out.size(), in.size()}) mpi_count(n * kNodes);
    neighbours_.back().out.resize(out.size() * kNodes);
    neighbours_.back().in.resize(in.size() * kNodes);
  }
}

double BandNeighbours::sum(const std::vector<double>& of_blocks) {
  double sum = 0;
  if (rank_ > 0) MPI_Recv(&sum, 1, MPI_DOUBLE, rank_ - 1, 0, comm_, MPI_STATUS_IGNORE);
  for (const double s : of_blocks) sum += s;
  if (rank_ + 1 < n_ranks_) MPI_Send(&sum, 1, MPI_DOUBLE, rank_ + 1, 0, comm_);
  MPI_Bcast(&sum, 1, MPI_DOUBLE, n_ranks_ - 1, comm_);
  return sum;
}

void BandNeighbours::fill(float* values) {
  std::vector<MPI_Request> requests(2 * neighbours_.size());
  for (std::size_t k = 0; k < neighbours_.size(); ++k) {
    Neighbour& n = neighbours_[k];
    MPI_Irecv(n.in.data(), static_cast<int>(n.in.size()), MPI_FLOAT, n.rank, 1, comm_, &requests[2 * k]);
    for (std::size_t i = 0; i < n.sent.size(); ++i)
      std::copy_n(values + kNodes * static_cast<std::size_t>(n.sent[i]), kNodes, n.out.data() + kNodes * i);
    MPI_Isend(n.out.data(), static_cast<int>(n.out.size()), MPI_FLOAT, n.rank, 1, comm_, &requests[2 * k + 1]);
  }
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  for (const Neighbour& n : neighbours_) {
    for (std::size_t i = 0; i < n.received.size(); ++i)
      std::copy_n(n.in.data() + kNodes * i, kNodes, values + kNodes * static_cast<std::size_t>(n.received[i]));
  }
}

}  // namespace umtet
