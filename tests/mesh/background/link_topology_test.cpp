#include "mesh/background/link_topology.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "mesh/background/background_mesh.h"
#include "mesh/core/tet_quality.h"

namespace umtet {
namespace {

/// The star of one vertex as sets of ids, found without tables: what LinkTopology says as masks.
struct Star {
  BackgroundMesh background;
  std::int64_t vertex = 0;
  std::vector<std::int64_t> link;                         ///< ids, in the order of the masks
  std::vector<std::set<std::int64_t>> triangles;          ///< the tets at the vertex without it
  std::map<std::int64_t, std::set<std::int64_t>> nearby;  ///< of each link vertex

  explicit Star(int type, const Tiling& tiling = a15())
      : background(tiling, Box(Vec3::Zero(), 4 * Vec3(tiling.period[0], tiling.period[1], tiling.period[2])),
                   tiling.mean_edge) {
    vertex = background.vertex_id(type, {2, 2, 2});
    for (const Tiling::Corner& c : background.tiling_tables().link[type]) {
      link.push_back(vertex + background.id_step(type, c));
    }
    std::vector<std::int64_t> tets;
    background.star(vertex, tets);
    for (const std::int64_t t : tets) {
      std::set<std::int64_t> others;
      for (const std::int64_t v : background.tet(t)) {
        if (v != vertex) others.insert(v);
      }
      for (const std::int64_t v : others) nearby[v].insert(others.begin(), others.end());
      triangles.push_back(std::move(others));
    }
  }
};

template <class Nodes, class Adjacent>
bool connected(const Nodes& nodes, const Adjacent& adjacent) {
  if (nodes.empty()) return false;
  std::vector<typename Nodes::value_type> stack = {*nodes.begin()};
  Nodes seen = {*nodes.begin()};
  while (!stack.empty()) {
    const auto here = stack.back();
    stack.pop_back();
    for (const auto& other : nodes) {
      if (adjacent(here, other) && seen.insert(other).second) stack.push_back(other);
    }
  }
  return seen.size() == nodes.size();
}

LinkState brute_force(const Star& star, LinkMask mask) {
  std::set<std::int64_t> inside, outside;
  for (std::size_t k = 0; k < star.link.size(); ++k) (mask >> k & 1 ? inside : outside).insert(star.link[k]);
  const auto joined = [&](std::int64_t a, std::int64_t b) { return star.nearby.at(a).count(b) != 0; };
  LinkState s;
  s.simple = connected(inside, joined) && connected(outside, joined);
  // omega_h around the vertex: faces at the vertex by their other two corners, with the number of tets behind them.
  std::map<std::set<std::int64_t>, int> faces, positive;
  std::set<std::size_t> tets;
  for (std::size_t t = 0; t < star.triangles.size(); ++t) {
    std::set<std::int64_t> out;
    for (const std::int64_t v : star.triangles[t]) {
      if (outside.count(v)) out.insert(v);
    }
    if (out.size() == 3) continue;
    tets.insert(t);
    if (out.size() == 2) ++positive[out];
    for (const std::int64_t v : star.triangles[t]) {
      std::set<std::int64_t> face = star.triangles[t];
      face.erase(v);
      ++faces[face];
    }
  }
  s.n_tets = static_cast<std::uint8_t>(tets.size());
  for (const auto& [face, n] : positive) s.n_positive_faces = static_cast<std::uint8_t>(s.n_positive_faces + n);
  std::set<std::set<std::int64_t>> boundary;
  std::map<std::int64_t, int> degree;
  for (const auto& [face, n] : faces) {
    if (n != 1) continue;
    boundary.insert(face);
    for (const std::int64_t v : face) ++degree[v];
  }
  bool manifold = !boundary.empty() && positive.size() == boundary.size();
  for (const auto& [face, n] : positive) manifold &= n == 1 && boundary.count(face) != 0;
  for (const auto& [v, n] : degree) manifold &= n == 2;
  const auto share = [](const std::set<std::int64_t>& a, const std::set<std::int64_t>& b) {
    return std::any_of(a.begin(), a.end(), [&](std::int64_t v) { return b.count(v) != 0; });
  };
  manifold = manifold && connected(boundary, share);
  const auto share_face = [&](std::size_t a, std::size_t b) {
    return std::count_if(star.triangles[a].begin(), star.triangles[a].end(),
                         [&](std::int64_t v) { return star.triangles[b].count(v) != 0; }) >= 2;
  };
  s.manifold = manifold && connected(tets, share_face);
  return s;
}

TEST(LinkTopology, EveryLabellingOfBothSitesIsJudgedAsByBruteForce) {
  for (const int type : {0, 1, 2, 7}) {
    const Star star(type);
    const LinkTopology& link = a15_links()[type];
    ASSERT_EQ(link.states.size(), std::size_t{1} << star.link.size());
    const unsigned step = type == 1 || type == 7 ? 7 : 1;  // all of one type of each site, some of another
    std::size_t n_simple = 0, n_manifold = 0, n_not_simple_manifold = 0;
    for (unsigned mask = 0; mask < link.states.size(); mask += step) {
      const LinkState expected = brute_force(star, mask), &found = link.states[mask];
      ASSERT_EQ(found.simple, expected.simple) << type << " " << mask;
      ASSERT_EQ(found.n_tets, expected.n_tets);
      ASSERT_EQ(found.n_positive_faces, expected.n_positive_faces);
      if (found.simple) {
        ASSERT_EQ(found.manifold, expected.manifold) << type << " " << mask;
      }
      n_simple += found.simple;
      n_manifold += found.manifold;
      n_not_simple_manifold += found.manifold && !found.simple;
    }
    EXPECT_GT(n_simple, n_manifold);
    EXPECT_GT(n_manifold, 50u);
    EXPECT_EQ(n_not_simple_manifold, 0u);
  }
}

TEST(LinkTopology, ConfigurationsWithoutATableAreJudgedAsByBruteForce) {
  for (const Tiling* tiling : {&acute_slab(), &acute_cube()}) {
    SCOPED_TRACE(tiling->name);
    const std::vector<LinkTopology> links = link_topology(*tiling, tables(*tiling));
    std::set<int> sites;
    for (std::size_t type = 0; type < links.size(); ++type) {
      const LinkTopology& link = links[type];
      if (!link.states.empty() || !sites.insert(link.site).second) continue;
      const Star star(static_cast<int>(type), *tiling);
      std::size_t n_manifold = 0;
      std::uint64_t dice = 1;
      for (int k = 0; k < 60; ++k) {
        // One half of the link, a bit frayed: random masks are hardly ever simple.
        dice = dice * 6364136223846793005u + 1442695040888963407u;
        const Vec3 n = Vec3(double(dice >> 44), double(dice >> 24 & 0xfffff), double(dice >> 4 & 0xfffff)) / 524288. -
                       Vec3::Ones();
        LinkMask mask = 0;
        for (std::size_t i = 0; i < star.link.size(); ++i) {
          const Vec3 d = star.background.position(star.link[i]) - star.background.position(star.vertex);
          mask |= LinkMask{d.dot(n) > .1 * n.norm() * d.norm()} << i;
        }
        if (k % 3 == 0) mask ^= LinkMask{1} << k % link.n;
        const LinkState expected = brute_force(star, mask), found = link.state(mask);
        ASSERT_EQ(found.simple, expected.simple) << link.n << " " << mask;
        ASSERT_EQ(found.n_tets, expected.n_tets);
        ASSERT_EQ(found.n_positive_faces, expected.n_positive_faces);
        if (found.simple) {
          ASSERT_EQ(found.manifold, expected.manifold) << link.n << " " << mask;
        }
        n_manifold += found.manifold;
      }
      EXPECT_GT(n_manifold, 20u) << link.n;
    }
    EXPECT_EQ(sites.size(), tiling == &acute_slab() ? 1u : 7u);
  }
}

TEST(LinkTopology, TrianglesMakePositiveTetsAndWaysBackLeadBack) {
  for (int type = 0; type < 8; ++type) {
    const Star star(type);
    const LinkTopology& link = a15_links()[type];
    EXPECT_EQ(link.n, link.site == 0 ? 12 : 14);
    EXPECT_EQ(link.triangles.size(), link.site == 0 ? 20u : 24u);
    const auto place = [&](std::int64_t v) { return star.background.position(v); };
    for (const auto& t : link.triangles) {
      EXPECT_GT(volume6(place(star.vertex), place(star.link[t[0]]), place(star.link[t[1]]), place(star.link[t[2]])), 0);
    }
    for (int k = 0; k < link.n; ++k) {
      const int other = star.background.type(star.link[k]);
      const Tiling::Corner& back = star.background.tiling_tables().link[other][link.back[k]];
      EXPECT_EQ(star.link[k] + star.background.id_step(other, back), star.vertex);
    }
  }
}

}  // namespace
}  // namespace umtet
