#include "mesh/octree/graded_mesh.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>
#include <vector>

#include "mesh/background/background_mesh.h"
#include "mesh/background/explicit_mesh.h"
#include "mesh/base/id_set.h"
#include "mesh/core/tet_quality.h"
#include "mesh/submesh/crawl.h"
#include "mesh/submesh/submesh.h"
#include "tests/support/domains.h"
#include "tests/support/gradings.h"

namespace umtet {
namespace {

std::vector<Grading> gradings(int transition_sweeps = 0) {
  std::vector<Grading> all;
  for (std::uint64_t seed = 0; seed < 8; ++seed)
    all.push_back(testing::random_grading(seed, 4, .1 + .05 * double(seed)));
  for (std::uint64_t seed = 0; seed < 3; ++seed) all.push_back(testing::spots(seed, .01, .6));
  all.push_back(testing::spots(0, 3, .6));  // a leaf
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    all.push_back(testing::random_grading(seed, 4));
    // A family of eight here and there.
    all.back().wanted = [](const Vec3& x, double half_width) {
      return half_width > .3 || std::llround((x.sum() + 7) / half_width) % 5 != 0;
    };
  }
  for (Grading& g : all) g.transition_sweeps = transition_sweeps;
  return all;
}

/// ExplicitMesh refuses tets that are not positive (exactly), and faces of more than two tets or two on one side.
void is_conforming(const Grading& g) {
  const GradedMesh graded(g);
  const TetMesh mesh = testing::to_tet_mesh(graded);
  const ExplicitMesh stored(mesh);
  double volume = 0, q_min = 1;
  for (const Tet& t : mesh.C) {
    volume += volume6(mesh.V[t[0]], mesh.V[t[1]], mesh.V[t[2]], mesh.V[t[3]]) / 6;
    q_min = std::min(q_min, mean_ratio(mesh, t));
  }
  EXPECT_GT(q_min, g.transition_sweeps == 0 ? .7559 : .73);
  if (g.wanted) return;
  EXPECT_NEAR(volume / graded.box().volume(), 1, 1e-10);
  for (std::size_t v = 0; v < mesh.V.size(); ++v) {
    const double to_wall =
        std::min((mesh.V[v] - graded.box().min()).minCoeff(), (graded.box().max() - mesh.V[v]).minCoeff());
    ASSERT_EQ(stored.on_boundary(static_cast<int>(v)), std::abs(to_wall) < 1e-9);
  }
}

TEST(GradedMesh, IsAConformingMeshThatFillsItsRoot) {
  for (const int sweeps : {0, 8}) {
    for (const Grading& g : gradings(sweeps)) is_conforming(g);
  }
}

TEST(GradedMesh, AReaderReadsTheTetsInAnyOrder) {
  std::mt19937_64 random(1);
  for (const Grading& g : gradings()) {
    const GradedMesh graded(g);
    std::vector<std::int64_t> order(static_cast<std::size_t>(graded.n_tets()));
    std::iota(order.begin(), order.end(), 0);
    for (int n = 0; n < 3; ++n) {
      GradedMesh::Reader reader = graded.reader();
      for (const std::int64_t t : order) ASSERT_EQ(reader.tet(t), graded.tet(t));
      if (n == 0) std::reverse(order.begin(), order.end());
      if (n == 1) std::shuffle(order.begin(), order.end(), random);
    }
  }
}

/// The worst tets are as good as smooth_transitions() says, but at the background boundary, which cannot move.
TEST(GradedMesh, TransitionsAreSmoothed) {
  std::vector<Grading> all = {testing::spots(1, .006, .4), testing::spots(2, .01, .8)};
  for (std::uint64_t seed = 0; seed < 4; ++seed)
    all.push_back(testing::random_grading(seed, 5, .2 + .1 * double(seed)));
  for (Grading g : all) {
    double before = 1;
    for (const int sweeps : {0, 8}) {
      g.transition_sweeps = sweeps;
      const GradedMesh graded(g);
      const TetMesh mesh = testing::to_tet_mesh(graded);
      double q_min = 1, least = 180, greatest = 0;
      for (const Tet& t : mesh.C) {
        if (std::any_of(t.begin(), t.end(), [&](int v) { return graded.on_boundary(v); })) continue;
        q_min = std::min(q_min, mean_ratio(mesh, t));
        const DihedralRange angles = dihedral_range(mesh.V[t[0]], mesh.V[t[1]], mesh.V[t[2]], mesh.V[t[3]]);
        least = std::min(least, angles.min_deg);
        greatest = std::max(greatest, angles.max_deg);
      }
      if (sweeps == 0) {
        before = q_min;
        EXPECT_NEAR(least, 45, 1e-6);
        EXPECT_NEAR(greatest, 120, 1e-6);
      } else {
        EXPECT_NEAR(before, .7560, 1e-3);
        EXPECT_GT(q_min, .776);
        EXPECT_GT(least, 34);
        EXPECT_LT(greatest, 120);
      }
    }
  }
}

void are_same(const GradedMesh& a, const GradedMesh& b) {
  ASSERT_EQ(a.n_vertices(), b.n_vertices());
  ASSERT_EQ(a.n_tets(), b.n_tets());
  for (std::int64_t v = 0; v < a.n_vertices(); ++v) {
    ASSERT_EQ(a.key(v), b.key(v));
    ASSERT_EQ(a.position(v), b.position(v));
  }
  for (std::int64_t t = 0; t < a.n_tets(); ++t) ASSERT_EQ(a.tet(t), b.tet(t));
}

TEST(GradedMesh, IsTheSameForAnyNumberOfThreads) {
  const Grading g = testing::spots(0, .01, .5);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const GradedMesh expected(g);
  for (const std::size_t n : {2, 4}) {
    const tbb::global_control more(tbb::global_control::max_allowed_parallelism, n);
    are_same(GradedMesh(g), expected);
  }
}

/// The vertices of a grading are vertices of a finer one. Where the leaves are the same, so are the tets, and as far as
/// smoothing does not reach, the positions.
TEST(GradedMesh, KeepsItsKeysWhereAnotherPlaceIsRefined) {
  for (const int sweeps : {0, 2}) {
    Grading g = testing::spots(0, .03, .08, 2);
    g.transition_sweeps = sweeps;
    const GradedMesh coarse(g);
    const Vec3 where(.9, .9, .9);
    g.size = [&, size_elsewhere = g.size](const Vec3& x, double half_width) {
      const double distance = ((x - where).cwiseAbs().array() - half_width).max(0).matrix().norm();
      return distance > .3 ? size_elsewhere(x, half_width) : .03;
    };
    const GradedMesh fine(g);
    EXPECT_GT(fine.n_vertices(), coarse.n_vertices() + 1000);
    std::int64_t moved = 0;
    for (std::int64_t v = 0; v < coarse.n_vertices(); ++v) {
      const std::int64_t same = fine.vertex_of(coarse.key(v));
      const Vec3 x = coarse.position(v);
      ASSERT_GE(same, 0);  // a leaf's centre is a corner of its children
      ASSERT_EQ(fine.key(same), coarse.key(v));
      if (fine.position(same) == x) continue;
      ++moved;
      ASSERT_LT((x - where).norm(), 1.5);
    }
    EXPECT_EQ(moved == 0, sweeps == 0);
    std::vector<std::uint64_t> keys;
    for (std::int64_t t = 0; t < fine.n_tets(); ++t) keys.push_back(fine.tet_key(t));
    EXPECT_TRUE(std::is_sorted(keys.begin(), keys.end()));
    EXPECT_TRUE(std::adjacent_find(keys.begin(), keys.end()) == keys.end());
    std::int64_t kept = 0;
    for (std::int64_t t = 0; t < coarse.n_tets(); ++t) {
      const auto same = std::lower_bound(keys.begin(), keys.end(), coarse.tet_key(t));
      if (same == keys.end() || *same != coarse.tet_key(t)) continue;
      const auto a = coarse.tet(t), b = fine.tet(same - keys.begin());
      const bool equal = std::equal(a.begin(), a.end(), b.begin(),
                                    [&](std::int64_t v, std::int64_t w) { return coarse.key(v) == fine.key(w); });
      kept += equal;
      if (!equal) {  // an edge that is split now
        ASSERT_LT((coarse.position(a[0]) - where).norm(), 1);
      }
    }
    EXPECT_GT(kept, coarse.n_tets() / 2);
  }
}

TEST(GradedMesh, RefusesWhatItCannotMake) {
  const Grading good = testing::spots(0, .1, .5);
  EXPECT_NO_THROW(GradedMesh{good});
  const auto refuses = [&](auto change) {
    Grading g = good;
    change(g);
    EXPECT_THROW(GradedMesh{g}, std::invalid_argument);
  };
  refuses([](Grading& g) { g.box.setEmpty(); });
  refuses([](Grading& g) { g.finest = 0; });
  refuses([](Grading& g) { g.finest = 1e-7; });  // levels
  refuses([](Grading& g) { g.tolerance = 0; });
  refuses([](Grading& g) { g.size = {}; });
  refuses([](Grading& g) { g.size = [](const Vec3&, double) { return 0.; }; });
  refuses([](Grading& g) { g.size = [](const Vec3&, double) { return std::nan(""); }; });
  refuses([](Grading& g) { g.max_leaves = 100; });
}

TEST(GradedMesh, CoversAllCubesThatAreWanted) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    Grading g = testing::random_grading(seed, 4);
    const std::int64_t all = GradedMesh(g).n_leaves();
    const Vec3 ball = Vec3(.3, -1.4, 4.2);
    g.wanted = [&](const Vec3& x, double half_width) {
      return ((x - ball).cwiseAbs().array() - half_width).max(0).matrix().norm() < .5;
    };
    const GradedMesh graded(g);
    EXPECT_LT(graded.n_leaves(), all);
    const TetMesh mesh = testing::to_tet_mesh(graded);
    const ExplicitMesh stored(mesh);
    for (std::size_t v = 0; v < mesh.V.size(); ++v) {
      if (stored.on_boundary(static_cast<int>(v))) {
        EXPECT_GT((mesh.V[v] - ball).norm(), .5);
      }
    }
  }
}

IdSet vertices_in_ball(const GradedMesh& mesh, double radius) {
  IdSet in(mesh.n_vertices());
  for (std::int64_t v = 0; v < mesh.n_vertices(); ++v) {
    if ((mesh.position(v) - mesh.position(mesh.n_vertices() / 2)).norm() < radius) in.insert(v);
  }
  return in;
}

TEST(GradedMesh, AroundVerticesHasTheirTets) {
  std::int64_t n_left = 0, n_all = 0;
  for (const Grading& g : gradings()) {
    const GradedMesh all(g);
    for (const int rings : {0, 1, 3}) {
      const IdSet given = vertices_in_ball(all, .3);
      IdSet near = given;
      const GradedMesh some = all.around(given, rings, 0);
      n_left += some.n_tets(), n_all += all.n_tets();
      std::vector<std::int64_t> link;
      for (int ring = 0; ring < rings; ++ring) {
        link.clear();
        near.for_each([&](std::int64_t v) { all.link(v, link); });
        for (const std::int64_t w : link) near.insert(w);
      }
      near.for_each([&](std::int64_t v) {
        const std::int64_t same = some.vertex_of(all.key(v));
        ASSERT_GE(same, 0);
        ASSERT_EQ(some.position(same), all.position(v));
        ASSERT_EQ(some.on_boundary(same), all.on_boundary(v));
        if (!given.test(v) || rings == 0) return;
        std::vector<std::int64_t> expected, star;
        all.star(v, expected);
        some.star(same, star);
        ASSERT_EQ(star.size(), expected.size());
        for (std::size_t t = 0; t < star.size(); ++t) ASSERT_EQ(some.tet_key(star[t]), all.tet_key(expected[t]));
      });
    }
  }
  EXPECT_LT(n_left, n_all / 2);
}

TEST(GradedMesh, KnowsWhoMeetsWhomAsAStoredMeshDoes) {
  std::vector<GradedMesh> all;
  for (const Grading& g : gradings()) {
    all.emplace_back(g);
    all.push_back(all.back().around(vertices_in_ball(all.back(), .3), 1, 0));
  }
  for (const GradedMesh& graded : all) {
    const ExplicitMesh stored(testing::to_tet_mesh(graded));
    std::vector<std::int64_t> list;
    for (int v = 0; v < graded.n_vertices(); ++v) {
      list.clear();
      graded.star(v, list);
      const auto star = stored.star(v);
      ASSERT_TRUE(std::equal(list.begin(), list.end(), star.begin(), star.end())) << v;
      list.clear();
      graded.link(v, list);
      const auto link = stored.link(v);
      ASSERT_TRUE(std::equal(list.begin(), list.end(), link.begin(), link.end())) << v;
      ASSERT_EQ(graded.vertex_of(graded.key(v)), v);
      ASSERT_EQ(graded.on_boundary(v), stored.on_boundary(v));
      ASSERT_NEAR(graded.mean_edge(v), stored.mean_edge(v), 1e-12);
    }
    for (int t = 0; t < graded.n_tets(); ++t) {
      for (int k = 0; k < 4; ++k) ASSERT_EQ(graded.neighbor(t, k), stored.neighbor(t, k)) << t << " " << k;
    }
  }
}

TEST(GradedMesh, FindsTheTetOfAPoint) {
  std::mt19937_64 random(0);
  for (const Grading& g : gradings(8)) {
    const GradedMesh graded(g);
    std::uniform_real_distribution<> part(0, 1);
    for (int i = 0; i < 2000; ++i) {
      const Vec3 x =
          graded.box().min() + graded.box().sizes().cwiseProduct(Vec3(part(random), part(random), part(random)));
      const std::int64_t t = graded.tet_at(x);
      if (t < 0) {
        ASSERT_TRUE(g.wanted);
        continue;
      }
      const auto c = graded.tet(t);
      for (const auto& f : kTetFace) {
        ASSERT_LT(volume6(graded.position(c[f[0]]), graded.position(c[f[1]]), graded.position(c[f[2]]), x), 1e-12);
      }
    }
    EXPECT_EQ(graded.tet_at(graded.box().max() + Vec3(.1, 0, 0)), -1);
    EXPECT_GE(graded.tet_at(graded.box().max()), g.wanted ? -1 : 0);
    EXPECT_GE(graded.tet_at(graded.box().min()), g.wanted ? -1 : 0);
  }
}

TEST(GradedMesh, AsABackgroundIsTheMeshItLists) {
  const auto domain = testing::torus();
  Grading g;
  g.box = domain.box;
  g.finest = .12;
  g.size = [](const Vec3& x, double half_width) { return .12 + .3 * std::max(0., x[0] - half_width); };
  g.transition_sweeps = 0;
  const BackgroundMesh graded{GradedMesh(g)}, stored(testing::to_tet_mesh(GradedMesh(g)));
  EXPECT_FALSE(graded.is_lattice());
  EXPECT_EQ(graded.h(), .12);
  const Submesh expected = find_submesh(stored, domain);
  for (const Submesh& found : {find_submesh(graded, domain), crawl(graded, domain, domain.boundary_seeds).submesh}) {
    EXPECT_EQ(found.mesh.C, expected.mesh.C);
    EXPECT_EQ(found.mesh.V, expected.mesh.V);
    EXPECT_EQ(found.background_tet, expected.background_tet);
    EXPECT_EQ(found.positive_faces, expected.positive_faces);
  }
  EXPECT_EQ(graded.vertex_of_key(-1), -1);
  EXPECT_EQ(stored.vertex_of_key(stored.n_vertices()), -1);
  for (std::int64_t v = 0; v < graded.n_vertices(); ++v) {
    ASSERT_EQ(graded.vertex_of_key(graded.key_of_vertex(v)), v);
    ASSERT_EQ(stored.vertex_of_key(stored.key_of_vertex(v)), v);
    ASSERT_NEAR(graded.h(v), stored.h(v), 1e-12);
    ASSERT_EQ(graded.on_boundary(v), stored.on_boundary(v));
  }
}

}  // namespace
}  // namespace umtet
