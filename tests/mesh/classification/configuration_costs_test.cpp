#include "mesh/classification/configuration_costs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "mesh/classification/tables/a15.h"
#include "mesh/classification/tables/cube.h"
#include "mesh/classification/tables/slab.h"

namespace umtet {
namespace {

TEST(ConfigurationCosts, AreKnownForEveryTilingOfOurs) {
  for (const std::string_view name : tiling_names())
    EXPECT_NE(configuration_costs(tiling_named(name)), nullptr) << name;
  Tiling other = a15();
  other.name = "mine";
  EXPECT_EQ(configuration_costs(other), nullptr);
}

TEST(ConfigurationCosts, FallAsTheMeasuredQualityRises) {
  const auto check = [](const Tiling& tiling, std::span<const ConfigurationQuality> list) {
    SCOPED_TRACE(tiling.name);
    const ConfigurationCosts& p = *configuration_costs(tiling);
    std::map<int, const LinkTopology*> link_of;
    for (const LinkTopology& link : p.links) link_of[link.site] = &link;
    std::set<int> sites;
    for (const ConfigurationQuality& q : list) {
      sites.insert(q.site);
      const LinkTopology& link = *link_of.at(q.site);
      ASSERT_LE(static_cast<std::size_t>(q.n_tets), link.triangles.size());
      const auto n = [](int k) { return static_cast<std::uint8_t>(k); };
      const LinkState s{
          .simple = true, .manifold = true, .n_positive_faces = n(q.n_positive_faces), .n_tets = n(q.n_tets)};
      EXPECT_LT(q.quality, p.good);
      EXPECT_NEAR(p.costs(q.site, s), std::min(100., 1e4 * std::pow(p.good - q.quality, 2)), 1e-3);
    }
    EXPECT_EQ(sites.size(), link_of.size());  // no kind of vertex is without costs
    EXPECT_GT(p.costs(0, LinkState{}), 500);  // no manifold
  };
  check(a15(), kA15ConfigurationQualities);
  check(acute_slab(), kSlabConfigurationQualities);
  check(acute_cube(), kCubeConfigurationQualities);
}

TEST(ConfigurationCosts, OfZAreThoseOfA15AtSitesOfAsManyNeighbours) {
  std::map<std::pair<int, std::pair<int, int>>, float> known;  // neighbours, positive faces, tets
  const ConfigurationCosts& a = *configuration_costs(a15());
  for (const LinkTopology& link : a.links) {
    for (const LinkState& s : link.states) {
      if (s.manifold) known[{link.n, {s.n_positive_faces, s.n_tets}}] = a.costs(link.site, s);
    }
  }
  const ConfigurationCosts& z = *configuration_costs(z_phase());
  std::map<int, int> compared;
  for (const LinkTopology& link : z.links) {
    const int like = link.n == 15 ? 14 : link.n;
    for (const LinkState& s : link.states) {
      const auto at = known.find({like, {s.n_positive_faces, s.n_tets}});
      if (!s.manifold || at == known.end()) continue;
      ASSERT_EQ(z.costs(link.site, s), at->second) << link.n;
      ++compared[link.n];
    }
  }
  EXPECT_EQ(compared.size(), 3u);  // 12, 14 and 15 neighbours
}

TEST(ConfigurationCosts, OnlyTheCubeCountsLengthsVertexByVertex) {
  for (const Tiling* tiling : {&a15(), &z_phase(), &acute_slab()}) {
    for (const LinkTopology& link : configuration_costs(*tiling)->links) EXPECT_EQ(link.unit, 1) << tiling->name;
  }
  float least = 10, greatest = 0;
  for (const LinkTopology& link : configuration_costs(acute_cube())->links) {
    least = std::min(least, link.unit);
    greatest = std::max(greatest, link.unit);
  }
  EXPECT_LT(least, .6);
  EXPECT_GT(greatest, 1.5);
}

}  // namespace
}  // namespace umtet
