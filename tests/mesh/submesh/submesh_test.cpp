#include "mesh/submesh/submesh.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "mesh/sizes/body_size.h"
#include "mesh/submesh/crawl.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

using testing::AnalyticDomain;

BackgroundMesh background_of(const AnalyticDomain& domain, double n_tets) {
  return BackgroundMesh(a15(), domain.box, h_for_tets(domain, domain.box, n_tets));
}

void expect_equal(const Submesh& a, const Submesh& b) {
  EXPECT_EQ(a.background_vertex, b.background_vertex);
  EXPECT_EQ(a.background_tet, b.background_tet);
  EXPECT_EQ(a.mesh.V, b.mesh.V);
  EXPECT_EQ(a.mesh.C, b.mesh.C);
  EXPECT_EQ(a.positive_faces, b.positive_faces);
  EXPECT_EQ(a.positive_tets, b.positive_tets);
  EXPECT_EQ(a.positive_vertices, b.positive_vertices);
}

TEST(Submesh, SignsThatAreKnownSpareValuesAndChangeNothing) {
  // |grad psi| is at most `steepest` in the box: no zero within reach along the axes where |psi| is above that.
  std::size_t n_all_asked = 0, n_asked = 0;
  for (const AnalyticDomain& domain : testing::domains()) {
    const BackgroundMesh background = background_of(domain, 20000);
    const double reach = background.box().sizes().x() / static_cast<double>(background.n_cells()[0]) * (1 + 1e-9);
    double steepest = 0;
    for (std::int64_t v = 0; v < background.n_vertices(); ++v) {
      steepest = std::max(steepest, domain.gradient(background.position(v)).norm());
    }
    const KnownSigns known{[&](const Vec3& x) { return std::abs(domain.value(x)) > 2 * steepest * reach; }, reach};
    std::size_t n_all = 0, n_some = 0;
    const Submesh all = find_submesh(background, domain, &n_all);
    const Submesh some = find_submesh(background, domain, &n_some, {}, known);
    expect_equal(all, some);
    n_all_asked += n_all, n_asked += n_some;
  }
  EXPECT_LT(n_asked, n_all_asked);
}

TEST(Submesh, IsTheSetOfTetsWithAVertexInside) {
  for (const AnalyticDomain& domain : testing::domains()) {
    const BackgroundMesh background = background_of(domain, 6000);
    std::size_t n_psi = 0;
    const Submesh submesh = find_submesh(background, domain, &n_psi);
    std::vector<std::int64_t> expected;
    std::size_t n_vertices = 0;
    for (std::int64_t t = 0; t < background.n_tets(); ++t) {
      int n_inside = 0;
      for (const std::int64_t v : background.tet(t)) n_inside += domain.value(background.position(v)) < 0;
      if (n_inside > 0) expected.push_back(t);
    }
    for (std::int64_t v = 0; v < background.n_vertices(); ++v) n_vertices += background.has_tets(v);
    EXPECT_EQ(submesh.background_tet, expected) << domain.name;
    EXPECT_EQ(n_psi, n_vertices) << domain.name;
    for (std::size_t i = 0; i < submesh.mesh.V.size(); ++i) {
      ASSERT_EQ(submesh.mesh.V[i], background.position(submesh.background_vertex[i]));
    }
  }
}

TEST(Submesh, PositiveFacesAreTheBoundaryOrientedOutwards) {
  for (const AnalyticDomain& domain : testing::domains()) {
    const Submesh submesh = find_submesh(background_of(domain, 10000), domain);
    std::map<std::pair<int, int>, int> edges;  // directed: a closed oriented surface has each once, and its reverse
    for (std::size_t f = 0; f < submesh.positive_faces.size(); ++f) {
      const Triangle& face = submesh.positive_faces[f];
      for (int k = 0; k < 3; ++k) ++edges[{face[k], face[(k + 1) % 3]}];
      for (const int i : submesh.mesh.C[submesh.positive_tets[f]]) {
        const bool on_face = std::find(face.begin(), face.end(), i) != face.end();
        ASSERT_EQ(domain.value(submesh.mesh.V[i]) < 0, !on_face) << domain.name;
      }
    }
    long n_edges = 0;
    for (const auto& [edge, n] : edges) {
      ASSERT_EQ(n, 1) << domain.name;
      ASSERT_EQ(edges.count({edge.second, edge.first}), 1u) << domain.name;
      n_edges += edge.first < edge.second;
    }
    const long chi = static_cast<long>(submesh.positive_vertices.size()) - n_edges +
                     static_cast<long>(submesh.positive_faces.size());
    EXPECT_EQ(chi, 2 * domain.components - 2 * domain.genus) << domain.name;
  }
}

TEST(Submesh, DoesNotDependOnThreads) {
  const AnalyticDomain domain = testing::torus();
  const BackgroundMesh background = background_of(domain, 30000);
  tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Submesh serial = find_submesh(background, domain);
  tbb::global_control three(tbb::global_control::max_allowed_parallelism, 3);
  expect_equal(find_submesh(background, domain), serial);
}

TEST(Submesh, BothSearchesStopWhenAsked) {
  // The number of polls is that of the calling thread's share of the work.
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const AnalyticDomain ball = testing::sphere();
  const BackgroundMesh background = background_of(ball, 60000);
  for (const int stop : {1, 2, 3}) {
    int asked = 0;
    const Context context{.cancelled = [&] { return ++asked >= stop; }};
    EXPECT_THROW(find_submesh(background, ball, nullptr, context), Cancelled) << stop;
    asked = 0;
    EXPECT_THROW(crawl(background, ball, ball.boundary_seeds, context), Cancelled) << stop;
  }
}

TEST(Crawl, EqualsTheFullLoop) {
  for (const AnalyticDomain& domain : testing::domains()) {
    for (const double n_tets : {4000., 40000.}) {
      SCOPED_TRACE(domain.name);
      const BackgroundMesh background = background_of(domain, n_tets);
      std::size_t full = 0;
      const Submesh expected = find_submesh(background, domain, &full);
      const Crawl found = crawl(background, domain, domain.boundary_seeds);
      EXPECT_TRUE(found.lost_seeds.empty());
      expect_equal(found.submesh, expected);
      EXPECT_LT(found.n_psi_evaluations, full / 2);
    }
  }
}

TEST(Crawl, ASeedThatIsMissingLosesItsComponentOnly) {
  const AnalyticDomain four = testing::equation_13(3.2);
  const BackgroundMesh background = background_of(four, 20000);
  const std::vector<std::int64_t> all = find_submesh(background, four).background_tet;
  std::size_t n_tets = 0;
  for (std::size_t k = 0; k < four.boundary_seeds.size(); ++k) {
    SCOPED_TRACE(k);
    const std::vector<std::int64_t> component =
        crawl(background, four, {four.boundary_seeds[k]}).submesh.background_tet;
    EXPECT_FALSE(component.empty());
    n_tets += component.size();
    std::vector<std::int64_t> others;
    std::set_difference(all.begin(), all.end(), component.begin(), component.end(), std::back_inserter(others));

    std::vector<Vec3> seeds = four.boundary_seeds;
    seeds[k] = Vec3(40, 0, 0);
    const Crawl astray = crawl(background, four, seeds);
    EXPECT_EQ(astray.lost_seeds, std::vector<std::size_t>{k});
    EXPECT_EQ(astray.submesh.background_tet, others);

    seeds.erase(seeds.begin() + static_cast<std::ptrdiff_t>(k));
    const Crawl unseeded = crawl(background, four, seeds);
    EXPECT_TRUE(unseeded.lost_seeds.empty());
    expect_equal(unseeded.submesh, astray.submesh);
  }
  EXPECT_EQ(n_tets, all.size());  // four components, no tet in two of them
}

TEST(Crawl, NamesTheSeedsThatLeadNowhere) {
  const AnalyticDomain ball = testing::sphere();
  const Crawl found = crawl(background_of(ball, 5000), ball, {Vec3(40, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)});
  EXPECT_EQ(found.lost_seeds, std::vector<std::size_t>{0});
}

TEST(Crawl, CostGrowsWithTheSurface) {
  const AnalyticDomain ball = testing::sphere();
  const Crawl coarse = crawl(background_of(ball, 10000), ball, ball.boundary_seeds);
  const Crawl fine = crawl(background_of(ball, 80000), ball, ball.boundary_seeds);
  // Eight times the tets is four times the surface.
  EXPECT_LT(static_cast<double>(fine.n_psi_evaluations), 5. * static_cast<double>(coarse.n_psi_evaluations));
}

TEST(HForTets, HitsTheCountWithinTenPercent) {
  for (const AnalyticDomain& domain : testing::domains()) {
    for (const double n_tets : {20000., 200000.}) {
      const Submesh submesh = find_submesh(background_of(domain, n_tets), domain);
      EXPECT_NEAR(static_cast<double>(submesh.mesh.C.size()) / n_tets, 1, .1) << domain.name;
    }
  }
  EXPECT_THROW(h_for_tets(testing::sphere(), testing::sphere().box, 0), std::invalid_argument);
  EXPECT_THROW(h_for_tets(testing::sphere(), Box(Vec3(2, 2, 2), Vec3(3, 3, 3)), 1000), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
