#include "mesh/label_prices.h"

#include <gtest/gtest.h>

#include <map>
#include <utility>

namespace umtet {
namespace {

TEST(LabelPrices, AreKnownForAFewTilings) {
  EXPECT_NE(label_prices(a15()), nullptr);
  EXPECT_NE(label_prices(z_phase()), nullptr);
  EXPECT_EQ(label_prices(acute_slab()), nullptr);
  EXPECT_EQ(label_prices(acute_cube()), nullptr);
}

TEST(LabelPrices, OfZAreThoseOfA15AtSitesOfAsManyNeighbours) {
  std::map<std::pair<int, std::pair<int, int>>, float> known;  // neighbours, positive faces, tets
  const LabelPrices& a = *label_prices(a15());
  for (std::size_t type = 0; type < a.links.size(); ++type) {
    for (std::size_t m = 1; m < a.links[type].states.size(); ++m) {
      const LinkState& s = a.links[type].states[m];
      if (s.manifold) known[{a.links[type].n, {s.n_positive_faces, s.n_tets}}] = a.energies[type][m];
    }
  }
  const LabelPrices& z = *label_prices(z_phase());
  std::map<int, int> compared;
  for (std::size_t type = 0; type < z.links.size(); ++type) {
    const int like = z.links[type].n == 15 ? 14 : z.links[type].n;
    for (std::size_t m = 1; m < z.links[type].states.size(); ++m) {
      const LinkState& s = z.links[type].states[m];
      const auto at = known.find({like, {s.n_positive_faces, s.n_tets}});
      if (!s.manifold || at == known.end()) continue;
      ASSERT_EQ(z.energies[type][m], at->second) << type << " " << m;
      ++compared[z.links[type].n];
    }
  }
  EXPECT_EQ(compared.size(), 3u);  // 12, 14 and 15 neighbours
}

}  // namespace
}  // namespace umtet
