#include "distributed/partition/partition.h"

#include <algorithm>

#include "distributed/partition/first_share.h"

namespace umtet {
namespace {

// Cost of a block, in units of the evaluations of psi at its vertices, which take about 20 us for a cheap formula. A
// block with a piece of the boundary has about 130 positive faces of 10.8 us (docs/performance.md), and half of its
// tets. A block inside has 46 * 64 tets of about .3 us each for the certificate and the files, so pieces also have
// about equal memory.
constexpr std::uint8_t kOutside = 1, kInside = 40, kBoundary = 90;

// Peak memory of all ranks together: (479 - 40) MB for each 5 M tets (README.md, 20 M tets by 4 ranks; a waiting rank
// uses 40 MB).
constexpr double kBytesPerTet = 88;

std::uint8_t weight(const BackgroundMesh& lattice, const BlockCurve& curve, const BlockCurve::Block& block,
                    ImplicitFunctionRef psi) {
  if (!curve.holds(block)) return 0;
  int n_inside = 0;
  for (int corner = 0; corner < 8; ++corner) {
    BackgroundMesh::Cell cell;
    for (int a = 0; a < 3; ++a) {
      const std::int64_t c = (block[a] + (corner >> a & 1)) * BlockCurve::kCells - 1;
      cell[a] = std::min(c, lattice.n_cells()[a]);
    }
    n_inside += psi.value(lattice.position(lattice.vertex_id(0, cell))) < 0;
  }
  return n_inside == 0 ? kOutside : n_inside == 8 ? kInside : kBoundary;
}

}  // namespace

int Partition::owner(const BlockCurve::Block& block) const {
  const auto after = std::upper_bound(begins_.begin(), begins_.end() - 1, BlockCurve::place(block));
  return static_cast<int>(after - begins_.begin()) - 1;
}

Partition balanced_partition(MPI_Comm comm, const BackgroundMesh& lattice, ImplicitFunctionRef psi, double held) {
  int rank = 0, n_ranks = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &n_ranks);
  const BlockCurve curve(lattice);
  const auto n = static_cast<std::uint64_t>(n_ranks);
  const std::uint64_t share = (curve.length() + n - 1) / n;
  const std::uint64_t first = std::min(curve.length(), share * static_cast<std::uint64_t>(rank));
  const std::uint64_t last = std::min(curve.length(), first + share);
  std::vector<std::uint8_t> weights;
  std::uint64_t own = 0, before = 0, all = 0, half_blocks = 0;
  for (std::uint64_t place = first; place < last; ++place) {
    weights.push_back(weight(lattice, curve, BlockCurve::block_at(place), psi));
    own += weights.back();
    half_blocks += weights.back() == kInside ? 2 : weights.back() == kBoundary ? 1 : 0;
  }
  MPI_Exscan(&own, &before, 1, MPI_UINT64_T, MPI_SUM, comm);
  if (rank == 0) before = 0;  // not set by MPI
  MPI_Allreduce(&own, &all, 1, MPI_UINT64_T, MPI_SUM, comm);
  MPI_Allreduce(MPI_IN_PLACE, &half_blocks, 1, MPI_UINT64_T, MPI_SUM, comm);
  MPI_Bcast(&held, 1, MPI_DOUBLE, 0, comm);
  constexpr double kCellsOfHalf = BlockCurve::kCells * BlockCurve::kCells * BlockCurve::kCells / 2.;
  const double n_tets = static_cast<double>(half_blocks * lattice.tiling().tets.size()) * kCellsOfHalf;
  const double first_of_all = first_share(n_ranks, held, kBytesPerTet * n_tets);
  const auto is_share_of = [&](std::uint64_t sum, std::uint64_t r) {
    return static_cast<double>(sum) >=
           share_before(static_cast<int>(r), n_ranks, first_of_all) * static_cast<double>(all);
  };
  // Piece r begins at the first block for which the work of all blocks before it is at least the share of the ranks
  // before r.
  std::vector<std::uint64_t> found(n + 1, curve.length()), begins(n + 1);
  std::uint64_t next = 0;
  for (std::uint64_t place = first, sum = before; place < last; sum += weights[place++ - first]) {
    for (; next < n && is_share_of(sum, next); ++next) found[next] = std::min(found[next], place);
  }
  MPI_Allreduce(found.data(), begins.data(), static_cast<int>(n) + 1, MPI_UINT64_T, MPI_MIN, comm);
  begins[0] = 0;
  return Partition(std::move(begins));
}

}  // namespace umtet
