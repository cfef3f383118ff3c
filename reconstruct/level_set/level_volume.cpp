#include "reconstruct/level_set/level_volume.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace umtet {
namespace {

constexpr int kParts = 3;  // of a cell along each axis

/// The share of a cell, from its lowest corner on, where psi < 0.
double share_below(const LevelSet& psi, const Vec3& corner) {
  const LevelSetApart apart(psi);
  double sum = 0;
  for (int k = 0; k < kParts; ++k) {
    for (int j = 0; j < kParts; ++j) {
      for (int i = 0; i < kParts; ++i) {
        Vec3 g;
        const double v = apart.evaluate(corner + (Vec3(i, j, k) + Vec3::Constant(.5)) / kParts, &g, nullptr);
        const double width = std::max(g.lpNorm<1>() / kParts, 1e-12);
        sum += std::clamp(.5 - v / width, 0., 1.);
      }
    }
  }
  return sum / (kParts * kParts * kParts);
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
        const double share = high <= -slack ? 1 : share_below(psi, lattice.origin + lattice.h * Vec3(i, j, k));
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
