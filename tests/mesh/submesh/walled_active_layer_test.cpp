#include "mesh/submesh/walled_active_layer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <set>
#include <string_view>
#include <vector>

#include "mesh/core/tet_quality.h"
#include "mesh/sizes/body_size.h"
#include "mesh/submesh/assemble_submesh.h"
#include "mesh/universal_mesh.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

BackgroundMesh background_of(const Tiling& tiling, const testing::AnalyticDomain& domain, double n_tets) {
  return BackgroundMesh(tiling, domain.box, h_for_tets(tiling, domain, domain.box, n_tets));
}

TEST(WalledActiveLayer, HoldsTheRingsOfWhatMovesAndColoursShareNoTet) {
  for (const std::string_view name : tiling_names()) {
    SCOPED_TRACE(name);
    const auto domain = testing::torus();
    const BackgroundMesh background = background_of(tiling_named(name), domain, 15000);
    std::size_t n = 0;
    const IdSet inside = inside_vertices(background, domain, n);
    const Submesh submesh = find_submesh(background, domain);
    const BackgroundLayer part = walled_active_layer(background, inside);
    const ActiveLayer& layer = part.layer;
    std::set<std::int64_t> positive;
    for (const int i : submesh.positive_vertices) positive.insert(submesh.background_vertex[i]);
    std::vector<std::int64_t> star;
    for (int v = 0; v < static_cast<int>(layer.V.size()); ++v) {
      const std::int64_t id = part.background_vertex[v];
      ASSERT_EQ(layer.V[v], background.position(id));
      EXPECT_EQ(layer.role[v] == ActiveLayer::Role::Boundary, positive.erase(id) == 1);
      if (layer.role[v] == ActiveLayer::Role::Fixed) continue;
      for (int r = layer.ring_begin[v]; r < layer.ring_begin[v + 1]; ++r) {
        for (const int w : layer.C[layer.ring[r]]) ASSERT_TRUE(w == v || layer.colour[w] != layer.colour[v]);
      }
      star.clear();
      background.star(id, star);
      const auto in_omega_h = std::count_if(star.begin(), star.end(), [&](std::int64_t t) {
        return std::binary_search(submesh.background_tet.begin(), submesh.background_tet.end(), t);
      });
      ASSERT_EQ(layer.ring_begin[v + 1] - layer.ring_begin[v], in_omega_h);
    }
    EXPECT_TRUE(positive.empty());
  }
}

TEST(WalledActiveLayer, IsThatOfTheLattice) {
  const auto domain = testing::equation_9();
  const BackgroundMesh background = background_of(a15(), domain, 20000);
  std::size_t n = 0;
  const IdSet inside = inside_vertices(background, domain, n);
  const BackgroundLayer lattice = linked_active_layer(background, VertexLinks(background, a15_links()), inside),
                        any = walled_active_layer(background, inside);
  EXPECT_EQ(any.background_vertex, lattice.background_vertex);
  EXPECT_EQ(any.layer.role, lattice.layer.role);
  const auto sorted = [](std::vector<Tet> tets) {
    for (Tet& tet : tets) std::sort(tet.begin(), tet.end());
    std::sort(tets.begin(), tets.end());
    return tets;
  };
  EXPECT_EQ(sorted(any.layer.C), sorted(lattice.layer.C));
}

/// @return the worst quality of eq. (9) at 100k tets on a background [Rangarajan2018, Section 3.6]
double least_quality(const Tiling& tiling) {
  const auto domain = testing::equation_9();
  const UmResult r = universal_mesh(background_of(tiling, domain, 100000), domain);
  EXPECT_EQ(r.status, UmStatus::Success) << tiling.name << ": " << r.evidence.what;
  EXPECT_EQ(r.obtuse_conditioning_angles, 0u) << tiling.name;
  double least = 1;
  for (const Tet& tet : r.submesh.mesh.C) {
    least = std::min(least, mean_ratio(r.final[tet[0]], r.final[tet[1]], r.final[tet[2]], r.final[tet[3]]));
  }
  return least;
}

TEST(Backgrounds, FastModeMeshesEquationNineOnEach) {
  // What it makes, minus .01. Z has star costs, which classification needs.
  EXPECT_GT(least_quality(z_phase()), .81);
  EXPECT_GT(least_quality(acute_slab()), .77);
  EXPECT_GT(least_quality(acute_cube()), .615);
}

}  // namespace
}  // namespace umtet
