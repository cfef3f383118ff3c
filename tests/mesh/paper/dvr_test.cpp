#include "mesh/paper/dvr.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

#include "mesh/core/tet_quality.h"
#include "mesh/paper/boundary_dvr.h"
#include "mesh/sizes/body_size.h"
#include "mesh/submesh/submesh.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

/// omega_h of a torus whose positive vertices are part of the way to the boundary: work for a relaxation.
struct Case {
  testing::AnalyticDomain domain = testing::torus();
  double h = h_for_tets(domain, domain.box, 8000);
  BackgroundMesh background{a15(), domain.box, h};
  Submesh submesh = find_submesh(background, domain);
  std::vector<int> interior;

  Case() {
    std::vector<int> all(submesh.mesh.V.size());
    std::iota(all.begin(), all.end(), 0);
    std::set_difference(all.begin(), all.end(), submesh.positive_vertices.begin(), submesh.positive_vertices.end(),
                        std::back_inserter(interior));
  }
  MovingMesh moved(double fraction) const {
    MovingMesh mesh(submesh.mesh, true);
    for (const int i : submesh.positive_vertices) {
      const Vec3 foot = closest_point(domain, mesh.V[i], h, {}).point;
      mesh.move(i, mesh.V[i] + fraction * (foot - mesh.V[i]));
    }
    return mesh;
  }
  double worst(const MovingMesh& mesh) const {
    double q = 1;
    for (const Tet& t : submesh.mesh.C)
      q = std::min(q, mean_ratio(mesh.V[t[0]], mesh.V[t[1]], mesh.V[t[2]], mesh.V[t[3]]));
    return q;
  }
};

double ring_quality(const MovingMesh& mesh, int i) {
  double q = 1;
  for (const Triangle& f : mesh.one_ring(i))
    q = std::min(q, mean_ratio(mesh.V[i], mesh.V[f[0]], mesh.V[f[1]], mesh.V[f[2]]));
  return q;
}

DvrParams params(DirectionRule rule, bool skip) {
  DvrParams p;
  p.directions = rule;
  p.skip_settled = skip;
  return p;
}

TEST(Dvr, MinimumOneRingQualityNeverDrops) {
  const Case c;
  for (const DirectionRule rule : {DirectionRule::AxesInTurn, DirectionRule::Random}) {
    MovingMesh mesh = c.moved(.4);
    for (int r = 0; r < 4; ++r) {
      for (const int i : c.interior) {
        const double before = ring_quality(mesh, i);
        dvr(mesh, RelaxationOrder(mesh, {i}), c.submesh.background_vertex, params(rule, true), r, 1);
        ASSERT_GE(ring_quality(mesh, i), before) << "vertex " << i << " iteration " << r;
        if (i > 200) break;  // a new order per vertex is for this test only
      }
    }
    const double before = c.worst(mesh);
    ASSERT_GT(before, 0);
    dvr(mesh, RelaxationOrder(mesh, c.interior), c.submesh.background_vertex, params(rule, true), 0, 6);
    EXPECT_GT(c.worst(mesh), before);
  }
}

TEST(Dvr, SkippingSettledVerticesChangesNoBit) {
  const Case c;
  for (const DirectionRule rule : {DirectionRule::AxesInTurn, DirectionRule::Random}) {
    MovingMesh lazy = c.moved(.4), eager = c.moved(.4);
    const RelaxationOrder order(lazy, c.interior);
    dvr(lazy, order, c.submesh.background_vertex, params(rule, true), 0, 10);
    dvr(eager, order, c.submesh.background_vertex, params(rule, false), 0, 10);
    EXPECT_EQ(lazy.V, eager.V);
  }
}

TEST(Dvr, LevelsGiveTheBitsOfTheSequentialOrder) {
  const Case c;
  MovingMesh by_level = c.moved(.4), one_by_one = c.moved(.4);
  const DvrParams p = params(DirectionRule::AxesInTurn, true);
  tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 3);
  dvr(by_level, RelaxationOrder(by_level, c.interior), c.submesh.background_vertex, p, 0, 2);
  std::vector<RelaxationOrder> single;
  for (const int i : c.interior) single.emplace_back(one_by_one, std::vector<int>{i});
  for (int r = 0; r < 2; ++r) {
    for (const RelaxationOrder& order : single) dvr(one_by_one, order, c.submesh.background_vertex, p, r, 1);
  }
  EXPECT_EQ(by_level.V, one_by_one.V);
}

TEST(Dvr, PerfectLatticeStaysBitForBit) {
  // Far from the origin too, where positions carry more rounding. This is what rings_are_optimal promises.
  for (const double far : {0., 1000.}) {
    testing::AnalyticDomain ball = testing::sphere();
    const auto psi = ball.psi;
    const Vec3 shift = Vec3::Constant(far);
    ball.psi = [psi, shift](const Vec3& x, Vec3* g, Mat3* H) { return psi(x - shift, g, H); };
    ball.box.translate(shift);
    const BackgroundMesh background(a15(), ball.box, .15);
    const Submesh submesh = find_submesh(background, ball);
    MovingMesh mesh(submesh.mesh);  // not told that its rings are optimal
    std::vector<int> interior;
    std::vector<bool> positive(mesh.V.size(), false);
    for (const int i : submesh.positive_vertices) positive[i] = true;
    for (int i = 0; i < static_cast<int>(positive.size()); ++i) {
      if (!positive[i]) interior.push_back(i);
    }
    const RelaxationOrder order(mesh, interior);
    for (const DirectionRule rule : {DirectionRule::AxesInTurn, DirectionRule::Random}) {
      EXPECT_EQ(dvr(mesh, order, submesh.background_vertex, params(rule, true), 0, 6), 0u);
    }
    EXPECT_EQ(mesh.V, submesh.mesh.V);
  }
}

TEST(RelaxationOrder, VisitsEveryWillingVertexOnce) {
  const Case c;
  const MovingMesh mesh(c.submesh.mesh);
  const RelaxationOrder order(mesh, c.interior);
  std::vector<std::atomic<int>> visits(mesh.V.size());
  order.for_each([](int i) { return i % 3 != 0; }, [&](int i) { ++visits[i]; });
  for (const int i : c.interior) ASSERT_EQ(visits[i], i % 3 != 0);
}

TEST(BoundaryDvr, KeepsVerticesOnTheBoundaryAndImprovesTheirRings) {
  const Case c;
  MovingMesh mesh = c.moved(.5);
  const RelaxationOrder inner(mesh, c.interior), boundary(mesh, c.submesh.positive_vertices);
  dvr(mesh, inner, c.submesh.background_vertex, params(DirectionRule::AxesInTurn, true), 0, 25);
  for (const int i : c.submesh.positive_vertices) mesh.move(i, closest_point(c.domain, mesh.V[i], c.h, {}).point);
  dvr(mesh, inner, c.submesh.background_vertex, params(DirectionRule::AxesInTurn, true), 0, 25);
  const double before = c.worst(mesh);
  ASSERT_GT(before, 0);
  const BoundaryDvrParams p{20, .5 * c.h, 0, {}};
  double last = before;
  for (int r = 0; r < 5; ++r) {
    boundary_dvr(mesh, boundary, c.submesh.background_vertex, c.domain, p, r);
    EXPECT_GE(c.worst(mesh), last);
    last = c.worst(mesh);
  }
  EXPECT_GT(last, before + .02);
  for (const int i : c.submesh.positive_vertices) {
    ASSERT_LT(std::abs(c.domain.value(mesh.V[i])) / c.domain.gradient(mesh.V[i]).norm(), 1e-9 * c.h);
  }
}

TEST(RandomUnitVector, IsUnitReproducibleAndCentred) {
  Vec3 mean = Vec3::Zero();
  const int n = 20000;
  for (int k = 0; k < n; ++k) {
    const Vec3 d = random_unit_vector(1, 2, k);
    ASSERT_NEAR(d.norm(), 1, 1e-14);
    mean += d / n;
  }
  EXPECT_LT(mean.norm(), 5 / std::sqrt(3. * n));  // five standard deviations of each component
  EXPECT_EQ(random_unit_vector(1, 2, 3), random_unit_vector(1, 2, 3));
  EXPECT_NE(random_unit_vector(1, 2, 3), random_unit_vector(2, 2, 3));
  EXPECT_NE(random_unit_vector(1, 2, 3), random_unit_vector(1, 3, 3));
}

}  // namespace
}  // namespace umtet
