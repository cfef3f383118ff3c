#include "distributed/exchange/neighbourhood.h"

#include <algorithm>
#include <utility>

#include "distributed/exchange/mpi_count.h"

namespace umtet {
namespace {

constexpr const char* kTooMuch = "an exchange of more than 2 GB";

struct Layout {
  std::vector<int> count, begin;
  Neighbourhood::Bytes bytes;
};

/// Concatenates messages. \throw std::length_error
Layout laid_out(const std::vector<Neighbourhood::Bytes>& messages) {
  Layout all;
  std::size_t n = 0;
  for (const auto& message : messages) {
    all.begin.push_back(static_cast<int>(n));
    all.count.push_back(mpi_count(message.size(), kTooMuch));
    n += message.size();
    mpi_count(n, kTooMuch);
  }
  return all;
}

}  // namespace

Neighbourhood::Neighbourhood(MPI_Comm comm, std::vector<int> ranks) : comm_(comm), ranks_(std::move(ranks)) {
  const int n = static_cast<int>(ranks_.size());
  MPI_Dist_graph_create_adjacent(comm_, n, ranks_.data(), MPI_UNWEIGHTED, n, ranks_.data(), MPI_UNWEIGHTED,
                                 MPI_INFO_NULL, 0, &graph_);
}

Neighbourhood::~Neighbourhood() {
  if (!unwinding_) MPI_Comm_free(&graph_);
}

std::size_t Neighbourhood::number(int rank) const {
  return static_cast<std::size_t>(std::lower_bound(ranks_.begin(), ranks_.end(), rank) - ranks_.begin());
}

std::vector<Neighbourhood::Bytes> Neighbourhood::exchange(const std::vector<Bytes>& out) {
  std::vector<int> there, here(out.size());
  for (const Bytes& message : out) there.push_back(mpi_count(message.size(), kTooMuch));
  MPI_Neighbor_alltoall(there.data(), 1, MPI_INT, here.data(), 1, MPI_INT, graph_);
  std::vector<Bytes> in;
  for (const int n : here) in.emplace_back(static_cast<std::size_t>(n));
  exchange(out, in);
  return in;
}

void Neighbourhood::exchange(const std::vector<Bytes>& out, std::vector<Bytes>& in) {
  Layout sent = laid_out(out), received = laid_out(in);
  for (const Bytes& message : out) {
    sent.bytes.insert(sent.bytes.end(), message.begin(), message.end());
    traffic_.messages += !message.empty();
  }
  for (const int n : received.count) received.bytes.resize(received.bytes.size() + static_cast<std::size_t>(n));
  ++traffic_.exchanges;
  traffic_.bytes += sent.bytes.size();
  MPI_Neighbor_alltoallv(sent.bytes.data(), sent.count.data(), sent.begin.data(), MPI_BYTE, received.bytes.data(),
                         received.count.data(), received.begin.data(), MPI_BYTE, graph_);
  for (std::size_t k = 0; k < in.size(); ++k)
    std::copy_n(received.bytes.begin() + received.begin[k], in[k].size(), in[k].begin());
}

std::size_t Neighbourhood::sum(std::size_t n) {
  unsigned long long own = n, all = 0;
  MPI_Allreduce(&own, &all, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM, comm_);
  ++traffic_.reductions;
  return all;
}

std::size_t Neighbourhood::max(std::size_t n) {
  unsigned long long own = n, all = 0;
  MPI_Allreduce(&own, &all, 1, MPI_UNSIGNED_LONG_LONG, MPI_MAX, comm_);
  ++traffic_.reductions;
  return all;
}

}  // namespace umtet
