#include "distributed/certify/part_tets.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "distributed/exchange/id_order.h"
#include "distributed/exchange/piece_chain.h"
#include "distributed/exchange/selection.h"
#include "mesh/certify/quality_report.h"
#include "mesh/certify/tet_sums.h"
#include "mesh/core/tet_packs.h"
#include "mesh/core/tet_quality.h"

namespace umtet {
namespace {

constexpr std::size_t kTetsPerPiece = 64 * kTetsPerSum;  // two megabytes
constexpr std::size_t kPacksPerTask = 1 << 8;
constexpr std::array<double, 3> kQuantiles = {0, .001, .01};

/// The data of a tet that are sent.
struct MeasuredTet {
  std::int64_t id;
  TetSums terms;
};

/// An extreme value over tets, and the first tet with this value.
struct ExtremeTet {
  double value = std::numeric_limits<double>::infinity();
  std::int64_t id = std::numeric_limits<std::int64_t>::max();
  double dihedral_deg = 0;
};

/// The extremes, counts and qualities of local tets, measured in rounds.
class OwnTets {
 public:
  OwnTets(const DistributedMesh& mesh, std::size_t n_lowest) : mesh_(mesh), n_lowest_(n_lowest) {}

  /// Measures tets first .. end - 1 and keeps their terms(). Each tet must be measured once, in ascending order.
  void measure(std::size_t first, std::size_t end);
  const TetSums& terms(std::size_t tet) const { return terms_[tet - first_]; }
  std::size_t n_inverted() const { return n_inverted_; }
  /// Returns the n_lowest least qualities of local tets, ascending.
  std::vector<double> lowest() &&;
  /// Returns the extreme, with the dihedral angle of the tet.
  ExtremeTet least_cotangent() const { return with_angle(least_, false); }
  ExtremeTet greatest_cotangent() const { return with_angle(greatest_, true); }

 private:
  ExtremeTet with_angle(const ExtremeTet& extreme, bool is_least_angle) const;
  void keep_lowest();

  const DistributedMesh& mesh_;
  std::size_t n_lowest_, first_ = 0, n_inverted_ = 0;
  std::vector<TetSums> terms_;
  std::vector<double> lowest_;
  ExtremeTet least_, greatest_;  ///< extreme cotangents with local tet numbers; the greatest has the opposite sign
};

void OwnTets::measure(std::size_t first, std::size_t end) {
  const std::size_t n = end - first, n_packs = (n + kPackSize - 1) / kPackSize;
  first_ = first;
  terms_.resize(n);
  std::vector<TetPack> packs(n_packs);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n_packs, kPacksPerTask), [&](const auto& range) {
    for (std::size_t p = range.begin(); p != range.end(); ++p) {
      const std::size_t at = p * kPackSize;
      packs[p] = measure_tet_pack(mesh_.mesh, &mesh_.mesh.C[first + at],
                                  static_cast<int>(std::min<std::size_t>(kPackSize, n - at)));
    }
  });
  for (std::size_t k = 0; k < n; ++k) {
    const TetPack& pack = packs[k / kPackSize];
    const std::size_t m = k % kPackSize;
    terms_[k] = {pack.volume6[m], pack.rms_edge[m], pack.quality[m]};
    lowest_.push_back(pack.quality[m]);
    n_inverted_ += pack.inverted[m];
    const auto place = static_cast<std::int64_t>(first + k);
    if (pack.least_cotangent[m] < least_.value) least_ = {pack.least_cotangent[m], place};
    if (-pack.greatest_cotangent[m] < greatest_.value) greatest_ = {-pack.greatest_cotangent[m], place};
  }
  if (lowest_.size() > 2 * n_lowest_) keep_lowest();
}

void OwnTets::keep_lowest() {
  if (lowest_.size() <= n_lowest_) return;
  std::nth_element(lowest_.begin(), lowest_.begin() + static_cast<std::ptrdiff_t>(n_lowest_), lowest_.end());
  lowest_.resize(n_lowest_);
}

std::vector<double> OwnTets::lowest() && {
  keep_lowest();
  std::sort(lowest_.begin(), lowest_.end());
  return std::move(lowest_);
}

ExtremeTet OwnTets::with_angle(const ExtremeTet& extreme, bool is_least_angle) const {
  if (mesh_.mesh.C.empty()) return extreme;
  // If all cotangents are NaN, one process takes its first tet.
  const bool has_none = extreme.id == std::numeric_limits<std::int64_t>::max();
  const std::size_t place = has_none ? 0 : static_cast<std::size_t>(extreme.id);
  const Tet& t = mesh_.mesh.C[place];
  const auto& V = mesh_.mesh.V;
  const DihedralRange range = dihedral_range(V[t[0]], V[t[1]], V[t[2]], V[t[3]]);
  return {extreme.value, mesh_.background_tet[place], is_least_angle ? range.min_deg : range.max_deg};
}

/// Returns the dihedral angle of the first tet of all ranks with the least value. Collective.
double angle_of_first(MPI_Comm comm, const ExtremeTet& own) {
  int n_ranks = 1;
  MPI_Comm_size(comm, &n_ranks);
  std::vector<ExtremeTet> all(static_cast<std::size_t>(n_ranks));
  MPI_Allgather(&own, sizeof own, MPI_BYTE, all.data(), sizeof own, MPI_BYTE, comm);
  const auto first = std::min_element(all.begin(), all.end(), [](const ExtremeTet& a, const ExtremeTet& b) {
    return a.value < b.value || (a.value == b.value && a.id < b.id);
  });
  return first->dihedral_deg;
}

}  // namespace

void measure_tets_of_parts(MPI_Comm comm, const DistributedMesh& mesh, double h, MeshCertificate& certificate) {
  const IdOrder order(comm, mesh.background_tet, kTetsPerPiece);
  const std::size_t n = order.n();
  OwnTets own(mesh, std::min(n, n / 100 + 2));  // what the quantiles need
  PieceChain sums(comm, 3);
  for (std::size_t round = 0; round < order.n_rounds(); ++round) {
    own.measure(order.begin(round), order.begin(round + 1));
    const std::vector<MeasuredTet> piece = order.piece<MeasuredTet>(round, [&](std::size_t t) {
      return MeasuredTet{mesh.background_tet[t], own.terms(t)};
    });
    std::vector<TetSums> blocks;
    for (std::size_t first = 0; first < piece.size(); first += kTetsPerSum) {
      blocks.push_back(block_sums(std::min(kTetsPerSum, piece.size() - first),
                                  [&](std::size_t k) -> const TetSums& { return piece[first + k].terms; }));
    }
    sums.pass([&](std::vector<double>& so_far) {
      TetSums all{so_far[0], so_far[1], so_far[2]};
      for (const TetSums& block : blocks) all.add(block);
      so_far = {all.volume6, all.rms_edges, all.qualities};
    });
  }
  const std::vector<double>& all = sums.end();
  MeshCertificate::Quality& quality = certificate.quality;
  quality.dihedral_min_deg = angle_of_first(comm, own.greatest_cotangent());
  quality.dihedral_max_deg = angle_of_first(comm, own.least_cotangent());
  std::uint64_t n_inverted = own.n_inverted();
  MPI_Allreduce(MPI_IN_PLACE, &n_inverted, 1, MPI_UINT64_T, MPI_SUM, comm);
  quality.n_inverted = n_inverted;

  std::vector<std::uint64_t> places;
  for (const double p : kQuantiles) {
    places.push_back(quantile_place(n, p).below);
    places.push_back(quantile_place(n, p).above);
  }
  const std::vector<double> lowest = values_at(comm, std::move(own).lowest(), places);
  const auto quantile_of = [&](std::size_t k) {
    return quantile_place(n, kQuantiles[k]).of(lowest[2 * k], lowest[2 * k + 1]);
  };
  quality.min = lowest.front();
  quality.p001 = quantile_of(1);
  quality.p01 = quantile_of(2);
  quality.mean = all[2] / static_cast<double>(n);
  certificate.volume = all[0] / 6;
  certificate.n_tets = n;
  certificate.h = h > 0 ? h : all[1] / static_cast<double>(n);
}

}  // namespace umtet
