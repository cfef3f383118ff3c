#include "mesh/fast/repair/detail/patch_ranges.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "mesh/base/id_list.h"

namespace umtet::detail {
namespace {

/// Of a tiling, as a share of its mean edge.
double longest_edge(const Tiling& tiling, const TilingTables& tables) {
  double longest2 = 0;
  for (std::size_t type = 0; type < tiling.points.size(); ++type) {
    for (const Tiling::Corner& c : tables.link[type]) {
      double d2 = 0;
      for (int k = 0; k < 3; ++k) {
        const double d = tiling.points[c.type][k] + c.offset[k] * tiling.period[k] - tiling.points[type][k];
        d2 += d * d;
      }
      longest2 = std::max(longest2, d2);
    }
  }
  return std::sqrt(longest2) / tiling.mean_edge;
}

}  // namespace

PatchRanges::PatchRanges(const BackgroundMesh& background, const VertexLinks& links, int reach)
    : background_(background), links_(links), reach_(reach) {
  if (!background.is_lattice()) return;
  far_of_lattice_ = (2 * reach + 5) * longest_edge(background.tiling(), background.tiling_tables()) * background.h();
}

/// Flips are within two edges, and what moves is within reach + 2; the classification and positions are read one edge
/// farther: by one of the two that are compared.
PatchRanges::Range PatchRanges::found(std::int64_t vertex) const {
  const Vec3 at = background_.position(vertex);
  if (background_.is_lattice()) return {at, far_of_lattice_};
  IdList ball;
  ball.add(vertex);
  std::size_t fresh = 0;
  for (int ring = 0; ring < reach_ + 3; ++ring) {
    for (const std::size_t end = ball.ids().size(); fresh < end; ++fresh) {
      links_.for_each(ball.ids()[fresh], [&](std::int64_t w) { ball.add(w); });
    }
  }
  double farthest2 = 0;
  for (const std::int64_t v : ball.ids()) farthest2 = std::max(farthest2, (background_.position(v) - at).squaredNorm());
  return {at, 2 * std::sqrt(farthest2)};
}

void PatchRanges::find(const std::vector<std::int64_t>& vertices) {
  if (background_.is_lattice()) return;
  std::vector<std::int64_t> fresh;
  for (const std::int64_t v : vertices) {
    if (known_.try_emplace(v).second) fresh.push_back(v);
  }
  tbb::parallel_for(std::size_t{0}, fresh.size(), [&](std::size_t k) { known_.at(fresh[k]) = found(fresh[k]); });
}

PatchRanges::Range PatchRanges::of(std::int64_t vertex) {
  const auto [known, is_new] = known_.try_emplace(vertex);
  if (is_new) known->second = found(vertex);
  return known->second;
}

}  // namespace umtet::detail
