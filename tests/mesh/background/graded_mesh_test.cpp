#include "mesh/background/graded_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "mesh/background/background_mesh.h"
#include "mesh/background/explicit_mesh.h"
#include "mesh/core/tet_quality.h"
#include "mesh/submesh/crawl.h"
#include "mesh/submesh/submesh.h"
#include "tests/support/domains.h"
#include "tests/support/gradings.h"

namespace umtet {
namespace {

std::vector<Grading> gradings() {
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
  return all;
}

/// ExplicitMesh refuses tets that are not positive (exactly), and faces of more than two tets or two on one side.
TEST(GradedMesh, IsAConformingMeshThatFillsItsRoot) {
  for (const Grading& g : gradings()) {
    const GradedMesh graded(g);
    const TetMesh mesh = to_tet_mesh(graded);
    const ExplicitMesh stored(mesh);
    double volume = 0, q_min = 1;
    for (const Tet& t : mesh.C) {
      volume += volume6(mesh.V[t[0]], mesh.V[t[1]], mesh.V[t[2]], mesh.V[t[3]]) / 6;
      q_min = std::min(q_min, mean_ratio(mesh, t));
    }
    EXPECT_GT(q_min, .7559);
    if (g.wanted) continue;
    EXPECT_NEAR(volume / graded.box().volume(), 1, 1e-10);
    for (std::size_t v = 0; v < mesh.V.size(); ++v) {
      const double to_wall =
          std::min((mesh.V[v] - graded.box().min()).minCoeff(), (graded.box().max() - mesh.V[v]).minCoeff());
      ASSERT_EQ(stored.on_boundary(static_cast<int>(v)), std::abs(to_wall) < 1e-9);
    }
  }
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
    const TetMesh mesh = to_tet_mesh(graded);
    const ExplicitMesh stored(mesh);
    for (std::size_t v = 0; v < mesh.V.size(); ++v) {
      if (stored.on_boundary(static_cast<int>(v))) EXPECT_GT((mesh.V[v] - ball).norm(), .5);
    }
  }
}

TEST(GradedMesh, KnowsWhoMeetsWhomAsAStoredMeshDoes) {
  for (const Grading& g : gradings()) {
    const GradedMesh graded(g);
    const ExplicitMesh stored(to_tet_mesh(graded));
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
  for (const Grading& g : gradings()) {
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
  const BackgroundMesh graded{GradedMesh(g)}, stored(to_tet_mesh(GradedMesh(g)));
  EXPECT_FALSE(graded.is_lattice());
  EXPECT_EQ(graded.h(), .12);
  const Submesh expected = find_submesh(stored, domain);
  for (const Submesh& found : {find_submesh(graded, domain), crawl(graded, domain, domain.boundary_seeds).submesh}) {
    EXPECT_EQ(found.mesh.C, expected.mesh.C);
    EXPECT_EQ(found.mesh.V, expected.mesh.V);
    EXPECT_EQ(found.background_tet, expected.background_tet);
    EXPECT_EQ(found.positive_faces, expected.positive_faces);
  }
  for (std::int64_t v = 0; v < graded.n_vertices(); ++v) {
    ASSERT_NEAR(graded.h(v), stored.h(v), 1e-12);
    ASSERT_EQ(graded.on_boundary(v), stored.on_boundary(v));
  }
}

}  // namespace
}  // namespace umtet
