#include "mesh/background/vertex_links.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <random>
#include <vector>

#include "mesh/core/tet_mesh.h"
#include "mesh/core/tet_quality.h"
#include "mesh/octree/graded_mesh.h"

namespace umtet {
namespace {

const Box kBox(Vec3::Constant(-1), Vec3::Constant(1));

/// All vertices of a lattice, with the same ids: those without a tet stay without one.
BackgroundMesh stored(const BackgroundMesh& lattice) {
  TetMesh mesh;
  for (std::int64_t v = 0; v < lattice.n_vertices(); ++v) mesh.V.push_back(lattice.position(v));
  for (std::int64_t t = 0; t < lattice.n_tets(); ++t) {
    const auto tet = lattice.tet(t);
    mesh.C.push_back(
        {static_cast<int>(tet[0]), static_cast<int>(tet[1]), static_cast<int>(tet[2]), static_cast<int>(tet[3])});
  }
  return BackgroundMesh(std::move(mesh));
}

/// Fine around a corner of the box, eight times as coarse at the other.
BackgroundMesh graded() {
  const Grading grading{.box = kBox, .finest = .05, .size = [](const Vec3& centre, double half_width) {
                          const double d = (centre - kBox.min()).norm() - std::sqrt(3.) * half_width;
                          return .05 + .2 * std::max(0., d);
                        }};
  return BackgroundMesh(GradedMesh(grading));
}

IdSet random_half(const BackgroundMesh& background) {
  std::mt19937 random(3);
  IdSet inside(background.n_vertices());
  for (std::int64_t v = 0; v < background.n_vertices(); ++v) {
    if (background.has_tets(v) && !background.on_boundary(v) && random() % 2 == 0) inside.insert(v);
  }
  return inside;
}

TEST(VertexLinks, ListedOnesSayTheSameAsThoseOfTheLattice) {
  const BackgroundMesh lattice(a15(), kBox, .25), same = stored(lattice);
  const VertexLinks expected(lattice, a15_links());
  const auto links = VertexLinks::listed(same);
  ASSERT_TRUE(links);
  const IdSet inside = random_half(lattice);
  std::size_t n_simple = 0, n_manifold = 0, n = 0;
  for (std::int64_t v = 0; v < lattice.n_vertices(); ++v) {
    if (!lattice.has_tets(v) || lattice.on_boundary(v)) continue;
    std::vector<std::int64_t> a, b;
    expected.for_each(v, [&](std::int64_t w) { a.push_back(w); });
    links->for_each(v, [&](std::int64_t w) { b.push_back(w); });
    std::sort(b.begin(), b.end());
    ASSERT_EQ(a, b);
    const LinkState x = expected.at(v).state(expected.mask(v, inside)), y = links->at(v).state(links->mask(v, inside));
    EXPECT_EQ(x.simple, y.simple);
    EXPECT_EQ(x.manifold, y.manifold);
    EXPECT_EQ(x.n_positive_faces, y.n_positive_faces);
    EXPECT_EQ(x.n_tets, y.n_tets);
    ++n, n_simple += x.simple, n_manifold += x.manifold;
  }
  EXPECT_GT(n, 1000u);
  EXPECT_GT(n_simple, 0u);
  EXPECT_GT(n_manifold, 0u);
}

TEST(VertexLinks, BackLeadsBack) {
  const BackgroundMesh background = graded();
  const auto links = VertexLinks::listed(background);
  ASSERT_TRUE(links);
  for (std::int64_t v = 0; v < background.n_vertices(); ++v) {
    const LinkTopology& link = links->at(v);
    double sum = 0;
    for (int k = 0; k < link.n; ++k) {
      const std::int64_t w = links->neighbour(v, k);
      sum += (background.position(w) - background.position(v)).norm();
      ASSERT_EQ(links->neighbour(w, link.back[k]), v);
    }
    std::vector<std::int64_t> star, same;
    background.star(v, star);
    ASSERT_EQ(link.triangles.size(), star.size());
    background.link(v, same);
    std::vector<std::int64_t> ring;
    for (int k = 0; k < link.n; ++k) ring.push_back(links->neighbour(v, k));
    for (const auto& t : link.triangles) {
      EXPECT_GT(volume6(background.position(v), background.position(ring[t[0]]), background.position(ring[t[1]]),
                        background.position(ring[t[2]])),
                0);
    }
    std::sort(ring.begin(), ring.end());
    EXPECT_EQ(ring, same);
    EXPECT_NEAR(link.unit * background.h() / (sum / link.n), 1, .01);
  }
}

TEST(VertexLinks, VerticesThatLookAlikeAreOfOneType) {
  const Grading even{.box = kBox, .finest = .1, .size = [](const Vec3&, double) { return .1; }};
  const BackgroundMesh bcc{GradedMesh(even)};
  const auto links = VertexLinks::listed(bcc);
  ASSERT_TRUE(links);
  std::vector<std::size_t> uses(links->topologies().size());
  for (std::int64_t v = 0; v < bcc.n_vertices(); ++v)
    uses[static_cast<std::size_t>(links->type(v))] += !bcc.on_boundary(v);
  // Off the boundary all have 14 neighbours in the same places; those next to it differ by what is behind them.
  EXPECT_GT(*std::max_element(uses.begin(), uses.end()), static_cast<std::size_t>(bcc.n_vertices()) / 2);
}

TEST(VertexLinks, DoNotDependOnTheNumberOfThreads) {
  const BackgroundMesh background = graded();
  const auto links = VertexLinks::listed(background);
  tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto alone = VertexLinks::listed(background);
  for (std::int64_t v = 0; v < background.n_vertices(); ++v) {
    ASSERT_EQ(links->type(v), alone->type(v));
    for (int k = 0; k < links->at(v).n; ++k) ASSERT_EQ(links->neighbour(v, k), alone->neighbour(v, k));
  }
}

}  // namespace
}  // namespace umtet
