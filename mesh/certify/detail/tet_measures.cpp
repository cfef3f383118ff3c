#include "mesh/certify/detail/tet_measures.h"

#include <oneapi/tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <vector>

#include "common/polled_loops.h"
#include "mesh/certify/certificate_memory.h"
#include "mesh/certify/quality_report.h"
#include "mesh/certify/tet_sums.h"
#include "mesh/core/tet_packs.h"
#include "mesh/core/tet_quality.h"

namespace umtet::detail {
namespace {

// A tet takes some tens of nanoseconds.
constexpr std::size_t kBlocksPerPoll = 1 << 8;
static_assert(kTetsPerSum % kPackSize == 0 && kPackSize == 4);  // the lanes of block_sums()
// The bound that the lowest twentieth of all qualities is below is estimated from this many blocks, evenly spread.
constexpr std::size_t kSampledBlocks = 64, kSampledShare = 20;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double sum(const Pack& a) { return (a[0] + a[1]) + (a[2] + a[3]); }
/// @param mask  result of a comparison: each element is -1 or 0
template <class Mask>
bool is_any(const Mask& mask) {
  return (mask[0] | mask[1] | mask[2] | mask[3]) != 0;
}

TetPack known_pack(const std::array<const TetValues*, kPackSize>& known) {
  TetPack result;
  for (int m = 0; m < kPackSize; ++m) {
    result.quality[m] = known[m]->quality;
    result.volume6[m] = known[m]->volume6;
    result.rms_edge[m] = known[m]->rms_edge;
    result.least_cotangent[m] = known[m]->least_cotangent;
    result.greatest_cotangent[m] = known[m]->greatest_cotangent;
    result.inverted[m] = known[m]->inverted;
  }
  return result;
}

/// Of tets first .. first + count - 1: what is known of all of them, or measured.
TetPack packs_of(const TetMesh& mesh, std::size_t first, int count, const CertificateMemory* memory) {
  if (memory) {
    std::array<const TetValues*, kPackSize> known;
    bool all = true;
    for (int m = 0; m < kPackSize; ++m) all &= (known[m] = memory->known(first + std::min(m, count - 1))) != nullptr;
    if (all) return known_pack(known);
  }
  return measure_tet_pack(mesh, &mesh.C[first], count);
}

void remember(const TetPack& tets, std::size_t first, int count, CertificateMemory& memory) {
  for (int m = 0; m < count; ++m) {
    memory.set(first + m, {.quality = tets.quality[m],
                           .volume6 = tets.volume6[m],
                           .rms_edge = tets.rms_edge[m],
                           .least_cotangent = tets.least_cotangent[m],
                           .greatest_cotangent = tets.greatest_cotangent[m],
                           .inverted = tets.inverted[m]});
  }
}

/// Sums and extremes over a block of tets.
struct TetMeasure {
  TetSums sums;
  std::size_t n_inverted = 0;
  double least_cotangent = kInfinity, greatest_cotangent = -kInfinity;
  std::size_t at_least = 0, at_greatest = 0;  ///< the first tets with these
  std::vector<double> low_qualities;          ///< those that are not above `low` of the call

  void take(double least, std::size_t at, double greatest, std::size_t at_other) {
    if (least < least_cotangent) least_cotangent = least, at_least = at;
    if (greatest > greatest_cotangent) greatest_cotangent = greatest, at_greatest = at_other;
  }
  void add(const TetMeasure& next) {
    sums.add(next.sums);
    n_inverted += next.n_inverted;
    take(next.least_cotangent, next.at_least, next.greatest_cotangent, next.at_greatest);
  }
};

/// The tets of one mesh, block by block.
class TetBlocks {
 public:
  TetBlocks(const TetMesh& mesh, CertificateMemory* memory, std::vector<char>& used)
      : mesh_(mesh), memory_(memory), used_(used) {}

  std::size_t size() const { return (mesh_.C.size() + kTetsPerSum - 1) / kTetsPerSum; }
  /// @param low  qualities up to it are listed in low_qualities
  TetMeasure operator()(std::size_t block, double low) const;

 private:
  void add(const TetPack& tets, std::size_t first, int count, TetMeasure& measure) const;

  const TetMesh& mesh_;
  CertificateMemory* memory_;
  std::vector<char>& used_;
};

TetMeasure TetBlocks::operator()(std::size_t block, double low) const {
  TetMeasure measure;
  Pack volume6{}, rms_edges{}, qualities{};
  std::array<double, kTetsPerSum> low_qualities;
  std::size_t n_low = 0;
  const std::size_t end = std::min(mesh_.C.size(), (block + 1) * kTetsPerSum);
  for (std::size_t first = block * kTetsPerSum; first < end; first += kPackSize) {
    const int count = static_cast<int>(std::min<std::size_t>(kPackSize, end - first));
    const TetPack tets = packs_of(mesh_, first, count, memory_);
    if (memory_) remember(tets, first, count, *memory_);
    if (count == kPackSize) {
      volume6 += tets.volume6;
      rms_edges += tets.rms_edge;
      qualities += tets.quality;
    } else {
      for (int m = 0; m < count; ++m) {
        volume6[m] += tets.volume6[m];
        rms_edges[m] += tets.rms_edge[m];
        qualities[m] += tets.quality[m];
      }
    }
    if (is_any(tets.quality <= low)) {
      for (int m = 0; m < count; ++m) {
        if (tets.quality[m] <= low) low_qualities[n_low++] = tets.quality[m];
      }
    }
    add(tets, first, count, measure);
  }
  measure.sums = {sum(volume6), sum(rms_edges), sum(qualities)};
  measure.low_qualities.assign(low_qualities.begin(), low_qualities.begin() + static_cast<std::ptrdiff_t>(n_low));
  return measure;
}

/// All but the sums.
void TetBlocks::add(const TetPack& tets, std::size_t first, int count, TetMeasure& measure) const {
  if (is_any((tets.least_cotangent < measure.least_cotangent) |
             (tets.greatest_cotangent > measure.greatest_cotangent))) {
    for (int m = 0; m < count; ++m) {
      measure.take(tets.least_cotangent[m], first + m, tets.greatest_cotangent[m], first + m);
    }
  }
  for (int m = 0; m < count; ++m) {
    measure.n_inverted += tets.inverted[m];
    for (const int v : mesh_.C[first + m]) std::atomic_ref(used_[v]).store(1, std::memory_order_relaxed);
  }
}

/// A bound below which there are about five times as many qualities as the 1 % quantile needs, estimated from some
/// blocks.
double sampled_bound(const TetBlocks& blocks) {
  if (blocks.size() <= kSampledBlocks) return kInfinity;
  std::vector<double> sample;
  for (std::size_t k = 0; k < kSampledBlocks; ++k) {
    const TetMeasure block = blocks(k * blocks.size() / kSampledBlocks, kInfinity);
    sample.insert(sample.end(), block.low_qualities.begin(), block.low_qualities.end());
  }
  const auto at = sample.begin() + static_cast<std::ptrdiff_t>(sample.size() / kSampledShare);
  std::nth_element(sample.begin(), at, sample.end());
  return *at;
}

DihedralRange dihedral_range_of(const TetMesh& mesh, const Tet& t) {
  return dihedral_range(mesh.V[t[0]], mesh.V[t[1]], mesh.V[t[2]], mesh.V[t[3]]);
}

}  // namespace

void measure_tets(const TetMesh& mesh, double h, const Context& context, CertificateMemory* memory,
                  MeshCertificate& certificate) {
  // Loops write by index and sums are taken block by block: threads cannot change a result.
  const std::size_t n = mesh.C.size(), n_lowest = std::min(n, n / 100 + 2);  // what the quantiles need
  std::vector<char> used(mesh.V.size(), 0);
  const TetBlocks tets(mesh, memory, used);
  std::vector<TetMeasure> blocks(tets.size());
  std::vector<double> lowest;
  for (double bound = sampled_bound(tets); lowest.size() < n_lowest; bound = kInfinity) {
    polled_parallel_for(blocks.size(), kBlocksPerPoll, context, [&](std::size_t b) { blocks[b] = tets(b, bound); });
    lowest.clear();
    for (const TetMeasure& block : blocks) {
      lowest.insert(lowest.end(), block.low_qualities.begin(), block.low_qualities.end());
    }
  }
  TetMeasure all;
  for (const TetMeasure& block : blocks) all.add(block);

  MeshCertificate::Quality& quality = certificate.quality;
  std::nth_element(lowest.begin(), lowest.begin() + static_cast<std::ptrdiff_t>(n_lowest - 1), lowest.end());
  tbb::parallel_sort(lowest.begin(), lowest.begin() + static_cast<std::ptrdiff_t>(n_lowest));
  quality.min = lowest.front();
  quality.p001 = quantile(lowest, n, .001);
  quality.p01 = quantile(lowest, n, .01);
  quality.mean = all.sums.qualities / static_cast<double>(n);
  quality.dihedral_min_deg = dihedral_range_of(mesh, mesh.C[all.at_greatest]).min_deg;
  quality.dihedral_max_deg = dihedral_range_of(mesh, mesh.C[all.at_least]).max_deg;
  quality.n_inverted = all.n_inverted;
  certificate.volume = all.sums.volume6 / 6;
  certificate.n_tets = n;
  certificate.n_vertices = static_cast<std::size_t>(std::count(used.begin(), used.end(), 1));
  certificate.h = h > 0 ? h : all.sums.rms_edges / static_cast<double>(n);
}

}  // namespace umtet::detail
