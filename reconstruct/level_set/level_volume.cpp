#include "reconstruct/level_set/level_volume.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace umtet {
namespace {

// A cell with a zero is halved this often along each axis.
constexpr int kHalvings = 2;

/// The share of a cube around `middle` where psi < 0.
double share_below(const LevelSetApart& psi, const Vec3& middle, double size, int halvings) {
  Vec3 g;
  Mat3 H;
  const double at_middle = psi.evaluate(middle, &g, &H);
  const double bend = size * size * H.norm();
  // By Taylor's formula no value in the cube differs by more; the factor is for the change of H within it.
  if (std::abs(at_middle) > .5 * size * g.lpNorm<1>() + bend) return at_middle < 0 ? 1 : 0;
  if (halvings == 0) {
    const double mean = at_middle + size * size * H.trace() / 24;
    return std::clamp(.5 - mean / std::max(size * g.lpNorm<1>(), 1e-12), 0., 1.);
  }
  double sum = 0;
  for (int q = 0; q < 8; ++q) {
    const Vec3 to(q & 1 ? 1 : -1, q & 2 ? 1 : -1, q & 4 ? 1 : -1);
    sum += share_below(psi, middle + size / 4 * to, size / 2, halvings - 1);
  }
  return sum / 8;
}

}  // namespace

std::vector<double> volumes_of_pieces(const LevelSet& psi, const std::vector<float>& nodes,
                                      const std::vector<std::int32_t>& owner, std::size_t n_pieces, double slack) {
  const Lattice& lattice = psi.coarsest().lattice;
  const Eigen::Vector3i& n = lattice.n;
  struct Share {
    std::int32_t piece;
    double volume;
  };
  std::vector<std::vector<Share>> of_slab(static_cast<std::size_t>(n[2]));
  const LevelSetApart apart(psi);
  tbb::parallel_for(0, n[2] - 1, [&](int k) {
    for (int j = 0; j + 1 < n[1]; ++j) {
      for (int i = 0; i + 1 < n[0]; ++i) {
        float low = nodes[lattice.index(i, j, k)], high = low;
        std::int32_t piece = -1;
        for (int c = 0; c < 8; ++c) {
          const std::ptrdiff_t at = lattice.index(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
          low = std::min(low, nodes[at]), high = std::max(high, nodes[at]);
          if (piece < 0) piece = owner[at];
        }
        if (piece < 0 || low >= slack) continue;
        const double share = high <= -slack ? 1 : share_below(apart, Vec3(i + .5, j + .5, k + .5), 1, kHalvings);
        if (share > 0) of_slab[k].push_back({piece, share});
      }
    }
  });
  std::vector<double> volume(n_pieces, 0);
  for (const auto& slab : of_slab)
    for (const Share& s : slab) volume[s.piece] += s.volume;
  return volume;
}

}  // namespace umtet
