#include "distributed/fit/part_refine.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

#include "distributed/exchange/collect.h"
#include "distributed/exchange/phase.h"
#include "distributed/fit/band_cut.h"
#include "distributed/fit/band_neighbours.h"
#include "reconstruct/solve/ssd_band.h"

namespace umtet {
namespace {

constexpr std::size_t kNodes = LatticeBlocks::kNodes;
constexpr std::size_t kSamplesAtOnce = 1 << 16;  // 6 MB
// Other bytes per sample on rank 0: position and normal, distances to neighbours, area, noise, and the ranks that share
// it.
constexpr double kHeldOfSample = 48 + 20 + 8 + 8 + 4;

/// Sends runs of samples in messages of a few megabytes, without a copy of all.
void send_runs(MPI_Comm comm, int rank, const std::vector<SsdSample>& samples, const std::vector<std::size_t>& runs,
               const std::vector<std::size_t>& list) {
  std::uint64_t n = 0;
  for (const std::size_t run : list) n += runs[run + 1] - runs[run];
  MPI_Send(&n, 1, MPI_UINT64_T, rank, 0, comm);
  std::vector<SsdSample> buffer;
  const auto send = [&] {
    MPI_Send(buffer.data(), static_cast<int>(buffer.size() * sizeof(SsdSample)), MPI_BYTE, rank, 0, comm);
    buffer.clear();
  };
  for (const std::size_t run : list) {
    for (std::size_t i = runs[run]; i < runs[run + 1]; ++i) {
      buffer.push_back(samples[i]);
      if (buffer.size() == kSamplesAtOnce) send();
    }
  }
  if (!buffer.empty()) send();
}

std::vector<SsdSample> received_runs(MPI_Comm comm) {
  std::uint64_t n = 0;
  MPI_Recv(&n, 1, MPI_UINT64_T, 0, 0, comm, MPI_STATUS_IGNORE);
  std::vector<SsdSample> samples(n);
  for (std::size_t at = 0; at < n; at += kSamplesAtOnce) {
    const std::size_t some = std::min(kSamplesAtOnce, n - at);
    MPI_Recv(samples.data() + at, static_cast<int>(some * sizeof(SsdSample)), MPI_BYTE, 0, 0, comm, MPI_STATUS_IGNORE);
  }
  return samples;
}

/// Distributes the samples of rank 0, and returns those that this rank needs. Collective.
std::vector<SsdSample> own_samples(MPI_Comm comm, const LatticeBlocks& blocks, const std::vector<int>& begin,
                                   std::vector<SsdSample> all) {
  if (rank_in(comm) != 0) return received_runs(comm);
  const std::vector<std::size_t> runs = block_runs(all);
  const auto lists = runs_of_ranks(blocks, begin, all, runs);
  for (std::size_t r = 1; r < lists.size(); ++r) send_runs(comm, static_cast<int>(r), all, runs, lists[r]);
  std::size_t n = 0;
  for (const std::size_t run : lists[0]) {  // in ascending order, so that no sample is overwritten before it is moved
    for (std::size_t i = runs[run]; i < runs[run + 1]; ++i) all[n++] = all[i];
  }
  all.resize(n);
  all.shrink_to_fit();
  return all;
}

/// Returns the coefficients of the whole band from the blocks of each rank. Collective.
std::vector<float> joined(MPI_Comm comm, const std::vector<int>& begin, const float* own) {
  constexpr std::size_t kAtOnce = 1 << 28;
  const int rank = rank_in(comm);
  std::vector<float> all(static_cast<std::size_t>(begin.back()) * kNodes);
  std::copy_n(own, static_cast<std::size_t>(begin[rank + 1] - begin[rank]) * kNodes,
              all.data() + static_cast<std::size_t>(begin[rank]) * kNodes);
  for (int r = 0; r + 1 < static_cast<int>(begin.size()); ++r) {
    const std::size_t end = static_cast<std::size_t>(begin[r + 1]) * kNodes;
    for (std::size_t at = static_cast<std::size_t>(begin[r]) * kNodes; at < end; at += kAtOnce)
      MPI_Bcast(all.data() + at, static_cast<int>(std::min(kAtOnce, end - at)), MPI_FLOAT, r, comm);
  }
  return all;
}

}  // namespace

BandPart band_part(MPI_Comm comm, const Lattice& lattice, int half_width, std::vector<SsdSample> samples) {
  begin_phase("bands");
  int n_ranks = 1;
  MPI_Comm_size(comm, &n_ranks);
  struct {
    double origin[3], h;
    int n[3], half_width;
  } head = {{lattice.origin[0], lattice.origin[1], lattice.origin[2]},
            lattice.h,
            {lattice.n[0], lattice.n[1], lattice.n[2]},
            half_width};
  MPI_Bcast(&head, sizeof head, MPI_BYTE, 0, comm);
  const std::size_t n_samples = samples.size();
  std::vector<Eigen::Vector3i> list;
  if (rank_in(comm) == 0) list = SsdBand::blocks_of(samples, half_width);
  broadcast(comm, list);
  const Lattice same{Vec3(head.origin), head.h, Eigen::Vector3i(head.n)};
  LatticeBlocks blocks(same, head.half_width, std::move(list));
  std::vector<int> begin;
  if (rank_in(comm) == 0) begin = cut_band(blocks, samples, n_ranks, kHeldOfSample);
  broadcast(comm, begin);
  samples = own_samples(comm, blocks, begin, std::move(samples));
  return {std::move(blocks), std::move(begin), std::move(samples), n_samples};
}

LevelSet refine_parts(MPI_Comm comm, const LevelSet& psi, BandPart part, const RefineParams& params,
                      const std::function<void(double)>& go_on, BandReport& report) {
  begin_phase("bands");
  const int half_width = psi.tables().half_width(), rank = rank_in(comm);
  const LatticeBlocks& blocks = part.blocks;
  const std::vector<int>& begin = part.begin;
  const Lattice& fine = blocks.lattice();
  const std::vector<int> known = with_neighbours(blocks, begin[rank], begin[rank + 1]);
  std::vector<Eigen::Vector3i> of_part;
  of_part.reserve(known.size());
  for (const int b : known) of_part.push_back(blocks.blocks()[static_cast<std::size_t>(b)]);
  const auto first = static_cast<int>(std::lower_bound(known.begin(), known.end(), begin[rank]) - known.begin());
  const std::vector<float> of_own = [&] {
    const SsdBand band(psi.tables(), LatticeBlocks(fine, half_width, std::move(of_part)), params.kappa, part.samples,
                       {first, first + begin[rank + 1] - begin[rank]});
    std::uint64_t n_nodes = band.n_active();
    MPI_Allreduce(MPI_IN_PLACE, &n_nodes, 1, MPI_UINT64_T, MPI_SUM, comm);
    report = {fine.h, params.kappa, part.n_samples, n_nodes};
    BandNeighbours others(comm, known, begin);
    return band_correction(band, psi, params.tolerance, params.max_iterations, go_on, report, &others);
  }();
  part.samples = {};
  psi.forget_below(std::numeric_limits<double>::infinity());
  return psi.with_band({blocks, joined(comm, begin, of_own.data() + static_cast<std::size_t>(first) * kNodes)});
}

}  // namespace umtet
