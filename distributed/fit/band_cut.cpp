#include "distributed/fit/band_cut.h"

#include <algorithm>

#include "distributed/partition/first_share.h"

namespace umtet {
namespace {

// Bytes of a sample, and of the functions at it.
constexpr double kBytesPerSample = 88 + 147;
// Cost of a block of 512 nodes, in samples: in memory five vectors of 2 kB per block against the bytes of a sample; in
// time about the same ratio, of the operations for the energy of a block to those for the functions of a sample.
constexpr double kSamplesPerBlock = 45;

/// Returns the block of the first functions at a sample.
int block_of(const LatticeBlocks& blocks, const SsdSample& s) { return blocks.at(cell_of(s) / LatticeBlocks::kEdge); }

}  // namespace

std::vector<int> cut_band(const LatticeBlocks& blocks, const std::vector<SsdSample>& samples, int n_ranks,
                          double held) {
  std::vector<double> work(static_cast<std::size_t>(blocks.size()), kSamplesPerBlock);
  for (const SsdSample& s : samples) ++work[static_cast<std::size_t>(block_of(blocks, s))];
  double all = 0;
  for (const double w : work) all += w;
  const double first = first_share(n_ranks, held * static_cast<double>(samples.size()), kBytesPerSample * all);
  std::vector<int> begin = {0};
  double done = 0;
  for (int b = 0; b < blocks.size(); ++b) {
    while (static_cast<int>(begin.size()) < n_ranks &&
           done >= all * share_before(static_cast<int>(begin.size()), n_ranks, first))
      begin.push_back(b);
    done += work[static_cast<std::size_t>(b)];
  }
  begin.resize(static_cast<std::size_t>(n_ranks) + 1, blocks.size());
  return begin;
}

int rank_of_block(const std::vector<int>& begin, int block) {
  return static_cast<int>(std::upper_bound(begin.begin(), begin.end(), block) - begin.begin()) - 1;
}

std::vector<int> with_neighbours(const LatticeBlocks& blocks, int begin, int end) {
  std::vector<int> known;
  for (int b = begin; b < end; ++b) {
    for (const int n : blocks.neighbours(b))
      if (n >= 0) known.push_back(n);
  }
  std::sort(known.begin(), known.end());
  known.erase(std::unique(known.begin(), known.end()), known.end());
  return known;
}

std::vector<std::vector<std::size_t>> runs_of_ranks(const LatticeBlocks& blocks, const std::vector<int>& begin,
                                                    const std::vector<SsdSample>& samples,
                                                    const std::vector<std::size_t>& runs) {
  std::vector<std::vector<std::size_t>> of_ranks(begin.size() - 1);
  for (std::size_t run = 0; run + 1 < runs.size(); ++run) {
    const Eigen::Vector3i cells = cell_of(samples[runs[run]]) / LatticeBlocks::kEdge;
    for (int q = 0; q < 8; ++q) {
      const int b = blocks.at(cells + Eigen::Vector3i(q & 1, q >> 1 & 1, q >> 2));
      if (b < 0) continue;
      auto& list = of_ranks[static_cast<std::size_t>(rank_of_block(begin, b))];
      if (list.empty() || list.back() != run) list.push_back(run);
    }
  }
  return of_ranks;
}

}  // namespace umtet
