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

TEST(LabelPrices, AreKnownForEveryTilingOfOurs) {
  for (const std::string_view name : tiling_names()) EXPECT_NE(label_prices(tiling_named(name)), nullptr) << name;
  Tiling other = a15();
  other.name = "mine";
  EXPECT_EQ(label_prices(other), nullptr);
}

TEST(LabelPrices, FallAsTheMeasuredQualityRises) {
  const auto check = [](const Tiling& tiling, std::span<const LabelQuality> list) {
    SCOPED_TRACE(tiling.name);
    const LabelPrices& p = *label_prices(tiling);
    std::map<int, const LinkTopology*> link_of;
    for (const LinkTopology& link : p.links) link_of[link.site] = &link;
    std::set<int> sites;
    for (const LabelQuality& q : list) {
      sites.insert(q.site);
      const LinkTopology& link = *link_of.at(q.site);
      ASSERT_LE(static_cast<std::size_t>(q.n_tets), link.triangles.size());
      const auto n = [](int k) { return static_cast<std::uint8_t>(k); };
      const LinkState s{
          .simple = true, .manifold = true, .n_positive_faces = n(q.n_positive_faces), .n_tets = n(q.n_tets)};
      EXPECT_LT(q.quality, p.good);
      EXPECT_NEAR(p.energies(q.site, s), std::min(100., 1e4 * std::pow(p.good - q.quality, 2)), 1e-3);
    }
    EXPECT_EQ(sites.size(), link_of.size());     // no kind of vertex is without prices
    EXPECT_GT(p.energies(0, LinkState{}), 500);  // no manifold
  };
  check(a15(), kA15LabelQualities);
  check(acute_slab(), kSlabLabelQualities);
  check(acute_cube(), kCubeLabelQualities);
}

TEST(LabelPrices, OfZAreThoseOfA15AtSitesOfAsManyNeighbours) {
  std::map<std::pair<int, std::pair<int, int>>, float> known;  // neighbours, positive faces, tets
  const LabelPrices& a = *label_prices(a15());
  for (const LinkTopology& link : a.links) {
    for (const LinkState& s : link.states) {
      if (s.manifold) known[{link.n, {s.n_positive_faces, s.n_tets}}] = a.energies(link.site, s);
    }
  }
  const LabelPrices& z = *label_prices(z_phase());
  std::map<int, int> compared;
  for (const LinkTopology& link : z.links) {
    const int like = link.n == 15 ? 14 : link.n;
    for (const LinkState& s : link.states) {
      const auto at = known.find({like, {s.n_positive_faces, s.n_tets}});
      if (!s.manifold || at == known.end()) continue;
      ASSERT_EQ(z.energies(link.site, s), at->second) << link.n;
      ++compared[link.n];
    }
  }
  EXPECT_EQ(compared.size(), 3u);  // 12, 14 and 15 neighbours
}

TEST(LabelPrices, OnlyTheCubeCountsLengthsVertexByVertex) {
  for (const Tiling* tiling : {&a15(), &z_phase(), &acute_slab()}) {
    for (const LinkTopology& link : label_prices(*tiling)->links) EXPECT_EQ(link.unit, 1) << tiling->name;
  }
  float least = 10, greatest = 0;
  for (const LinkTopology& link : label_prices(acute_cube())->links) {
    least = std::min(least, link.unit);
    greatest = std::max(greatest, link.unit);
  }
  EXPECT_LT(least, .6);
  EXPECT_GT(greatest, 1.5);
}

}  // namespace
}  // namespace umtet
