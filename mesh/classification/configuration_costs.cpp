#include "mesh/classification/configuration_costs.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "mesh/classification/tables/a15.h"
#include "mesh/classification/tables/cube.h"
#include "mesh/classification/tables/slab.h"
#include "mesh/core/quality_target.h"

namespace umtet {
namespace {

// The quality that costs nothing: above the best in the table of A15, .894, so that every configuration has a cost and
// good ones are distinguished from better ones.
constexpr double kGoodInA15 = .93;
// The same of the slab, whose best is .901, and of the cube, .834. Tables: star_costs slab 1 60, star_costs cube 1 40.
constexpr double kGoodInSlab = .936, kGoodInCube = .847;
// In place of kQualityTarget: what smoothing reaches on nearly every tet of the slab and of the cube. No tet of the
// cube itself is below .626. Measured on eq. (9): pipeline_tests --gtest_filter=Figure15.*
constexpr double kTargetInSlab = .78, kTargetInCube = .62;
// RepairParams::reach, at most. Patches of three edges are three and ten times as large on slab and cube as in A15, and
// mend no more there than those of two; nor do they outside of lattices, where they are three times as large.
constexpr int kReach = 3, kReachOnPlanes = 2, kReachInListed = 2;
// Of graded and stored backgrounds: BCC transitions begin at Q = .78 (docs/method.md, Section 13), and what is below
// this where they meet the boundary is seldom mended by a flip. Not measured on many bodies.
constexpr double kTargetInListed = .76;

/// Around a vertex of a flat boundary bv faces share 360 degrees and nt tets a half-space: five or six equilateral
/// triangles, and 2 pi / .551 = 11.4 regular tets. In A15, too, five and six faces are best, and few tets do no harm
/// (tables/a15.h). With these weights nine bodies have 347 bad tets of 1e4 at the boundary, with twice the first one
/// 419, without any 617 (graded_bench --benchmark_filter=graded_costs).
float cost_by_angles(int n_positive_faces, int n_tets) {
  const float faces = static_cast<float>(n_positive_faces) - 5.5F,
              tets = std::max(0.F, static_cast<float>(n_tets) - 13);
  return faces * faces + .2F * tets * tets;
}

std::vector<ConfigurationQuality> qualities_of_z(const std::vector<LinkTopology>& links) {
  std::vector<ConfigurationQuality> qualities;
  for (const ConfigurationQuality& q : kA15ConfigurationQualities) {
    const int n = q.site == 0 ? 12 : 14;
    for (const int like : {n, n == 14 ? 15 : n}) {
      const auto link = std::find_if(links.begin(), links.end(), [&](const LinkTopology& l) { return l.n == like; });
      qualities.push_back({link->site, q.n_positive_faces, q.n_tets, q.quality});
    }
  }
  return qualities;
}

/// Edges of the cube are .5 to 3.3 h long: lengths are counted in the mean edge of each vertex.
std::vector<LinkTopology> links_of_cube() {
  const Tiling& tiling = acute_cube();
  const TilingTables& all = tables(tiling);
  std::vector<LinkTopology> links = link_topology(tiling, all);
  for (std::size_t type = 0; type < links.size(); ++type) {
    double sum = 0;
    for (const Tiling::Corner& c : all.link[type]) {
      double square = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        const double d = tiling.points[static_cast<std::size_t>(c.type)][a] + c.offset[a] * tiling.period[a] -
                         tiling.points[type][a];
        square += d * d;
      }
      sum += std::sqrt(square);
    }
    links[type].unit = static_cast<float>(sum / links[type].n / tiling.mean_edge);
  }
  return links;
}

ConfigurationCosts costs(std::vector<LinkTopology> links, std::span<const ConfigurationQuality> qualities, double good,
                         double repair_target, int repair_reach) {
  StarCostTable costs(links, qualities, good);
  return {std::move(links), good, std::move(costs), repair_target, repair_reach};
}

const ConfigurationCosts& costs_of_a15() {
  static const ConfigurationCosts made =
      costs(a15_links(), kA15ConfigurationQualities, kGoodInA15, kQualityTarget, kReach);
  return made;
}

ConfigurationCosts costs_of_z() {
  std::vector<LinkTopology> links = link_topology(z_phase(), tables(z_phase()));
  const std::vector<ConfigurationQuality> qualities = qualities_of_z(links);
  return costs(std::move(links), qualities, kGoodInA15, kQualityTarget, kReach);
}

}  // namespace

const ConfigurationCosts* configuration_costs(const Tiling& tiling) {
  if (tiling.name == a15().name) return &costs_of_a15();
  if (tiling.name == z_phase().name) {
    static const ConfigurationCosts made = costs_of_z();
    return &made;
  }
  if (tiling.name == acute_slab().name) {
    static const ConfigurationCosts made =
        costs(link_topology(acute_slab(), tables(acute_slab())), kSlabConfigurationQualities, kGoodInSlab,
              kTargetInSlab, kReachOnPlanes);
    return &made;
  }
  if (tiling.name == acute_cube().name) {
    static const ConfigurationCosts made =
        costs(links_of_cube(), kCubeConfigurationQualities, kGoodInCube, kTargetInCube, kReachOnPlanes);
    return &made;
  }
  return nullptr;
}

std::optional<BackgroundCosts> background_costs(const BackgroundMesh& background,
                                                std::shared_ptr<const VertexLinks> links) {
  if (background.is_lattice()) {
    const ConfigurationCosts* of_tiling = configuration_costs(background.tiling());
    if (!of_tiling) return std::nullopt;
    if (!links) links = std::make_shared<const VertexLinks>(background, of_tiling->links);
    return BackgroundCosts{std::move(links), of_tiling->costs, of_tiling->repair_target, of_tiling->repair_reach};
  }
  if (!links) links = VertexLinks::listed(background);
  if (!links) return std::nullopt;
  StarCostTable costs(links->topologies(), cost_by_angles);
  return BackgroundCosts{std::move(links), std::move(costs), kTargetInListed, kReachInListed};
}

const StarCostTable& a15_star_costs() { return costs_of_a15().costs; }

}  // namespace umtet
