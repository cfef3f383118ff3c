#include "mesh/universal_mesh.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "mesh/core/tet_quality.h"
#include "mesh/sizes/body_size.h"
#include "mesh/submesh/assumptions.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

using testing::AnalyticDomain;

double min_quality(const Submesh& submesh, const std::vector<Vec3>& V) {
  double q = 1;
  for (const Tet& t : submesh.mesh.C) q = std::min(q, mean_ratio(V[t[0]], V[t[1]], V[t[2]], V[t[3]]));
  return q;
}

double volume(const UmResult& result) {
  double v6 = 0;
  for (const Tet& t : result.submesh.mesh.C) {
    v6 += volume6(result.final[t[0]], result.final[t[1]], result.final[t[2]], result.final[t[3]]);
  }
  return v6 / 6;
}

UmParams paper() {
  UmParams params;
  params.mode = UmMode::Paper;
  return params;
}

UmResult mesh_of(const AnalyticDomain& domain, double n_tets, const UmParams& params = paper()) {
  return universal_mesh(BackgroundMesh(a15(), domain.box, h_for_tets(domain, domain.box, n_tets)), domain, params);
}

TEST(UniversalMesh, EveryDomainGetsAMeshOnItsBoundaryWithGoodTets) {
  for (const AnalyticDomain& domain : testing::domains()) {
    SCOPED_TRACE(domain.name);
    const double h = h_for_tets(domain, domain.box, 12000);
    const UmResult result = universal_mesh(BackgroundMesh(a15(), domain.box, h), domain, paper());
    ASSERT_EQ(result.status, UmStatus::Success) << result.evidence.what;
    EXPECT_GT(min_quality(result.submesh, result.projected), .2);  // eq. (9) is coarse here
    EXPECT_GT(min_quality(result.submesh, result.final), .7);
    EXPECT_LT(result.conditioning_angle_max_deg, 78.47);  // the greatest dihedral angle of A15
    EXPECT_EQ(result.obtuse_conditioning_angles, 0u);
    EXPECT_EQ(result.double_positive_faces, 0u);
    for (const int i : result.submesh.positive_vertices) {
      const double distance = std::abs(domain.value(result.final[i])) / domain.gradient(result.final[i]).norm();
      ASSERT_LT(distance, 1e-8 * h);
    }
    if (domain.volume) {
      EXPECT_NEAR(volume(result) / *domain.volume, 1, .02);
    }
  }
}

TEST(UniversalMesh, SphereVolumeErrorFallsAsHSquared) {
  UmParams params = paper();
  params.paper.relaxation_iterations = 5;  // the volume is decided by where the boundary vertices are
  const AnalyticDomain ball = testing::sphere();
  const auto error = [&](double h) {
    return *ball.volume - volume(universal_mesh(BackgroundMesh(a15(), ball.box, h), ball, params));
  };
  const double coarse = error(.2), fine = error(.1);
  EXPECT_GT(fine, 0);  // inscribed
  EXPECT_NEAR(std::log2(coarse / fine), 2, .3);
}

TEST(UniversalMesh, DoesNotDependOnThreadsOrOnTheSearch) {
  UmParams params = paper();
  params.paper.relaxation_iterations = 6;
  const AnalyticDomain domain = testing::torus();
  const BackgroundMesh background(a15(), domain.box, h_for_tets(domain, domain.box, 20000));
  const auto bytes_differ = [](const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    return a.size() != b.size() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) != 0;
  };
  for (const DirectionRule rule : {DirectionRule::AxesInTurn, DirectionRule::Random}) {
    params.paper.directions = rule;
    params.submesh.search = SubmeshSearch::FullLoop;
    UmResult one, three;
    {
      tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
      one = universal_mesh(background, domain, params);
    }
    {
      tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 3);
      three = universal_mesh(background, domain, params);
    }
    EXPECT_FALSE(bytes_differ(one.final, three.final));
    EXPECT_EQ(one.n_psi_evaluations, three.n_psi_evaluations);
    params.submesh.search = SubmeshSearch::Crawl;
    const UmResult crawled = universal_mesh(background, domain, params, {}, domain.boundary_seeds);
    EXPECT_FALSE(bytes_differ(one.final, crawled.final));
    EXPECT_LT(crawled.n_psi_evaluations, one.n_psi_evaluations);
  }
}

TEST(UniversalMesh, SeedDecidesTheRandomDirections) {
  UmParams params = paper();
  params.paper.relaxation_iterations = 2;
  const AnalyticDomain ball = testing::sphere();
  const UmResult a = mesh_of(ball, 4000, params);
  EXPECT_EQ(mesh_of(ball, 4000, params).final, a.final);
  params.paper.seed = 1;
  EXPECT_NE(mesh_of(ball, 4000, params).final, a.final);
}

TEST(UniversalMesh, EmptyDomainIsAStatus) {
  const BackgroundMesh background(a15(), Box(Vec3(3, 3, 3), Vec3(4, 4, 4)), .2);
  const UmResult result = universal_mesh(background, testing::sphere(), paper());
  EXPECT_EQ(result.status, UmStatus::EmptyDomain);
  EXPECT_FALSE(result.evidence.what.empty());
}

/// No number where x > border; elsewhere a ball.
struct HalfKnown {
  double border;
  double value(const Vec3& x) const { return x.x() > border ? std::sqrt(border - x.x()) : x.norm() - 1; }
  Vec3 gradient(const Vec3& x) const { return x.normalized(); }
};

TEST(UniversalMesh, APsiThatIsNoNumberIsSaidToBeWithAPlace) {
  const BackgroundMesh background(a15(), Box(Vec3(3, 3, 3), Vec3(4, 4, 4)), .2);
  for (const UmMode mode : {UmMode::Fast, UmMode::Paper}) {
    UmParams params;
    params.mode = mode;
    const HalfKnown nowhere{-9}, somewhere{3.5};
    const UmResult none = universal_mesh(background, nowhere, params);
    EXPECT_EQ(none.status, UmStatus::PsiNotFinite);
    EXPECT_STREQ(to_string(none.status), "psi not finite");
    EXPECT_EQ(none.evidence.where, background.position(none.evidence.background_vertex));
    const UmResult some = universal_mesh(background, somewhere, params);
    EXPECT_EQ(some.status, UmStatus::EmptyDomain);
    EXPECT_GT(some.evidence.where.x(), 3.5);
    EXPECT_GT(some.evidence.count, 0u);
    EXPECT_LT(some.evidence.count, none.evidence.count);
  }
}

TEST(UniversalMesh, DomainThatLeavesTheBackgroundIsAStatus) {
  const BackgroundMesh background(a15(), testing::cube_box(.8), .2);
  const UmResult result = universal_mesh(background, testing::sphere(), paper());
  EXPECT_EQ(result.status, UmStatus::DomainLeavesBackground);
  EXPECT_GT(result.evidence.count, 0u);
  EXPECT_TRUE(background.on_boundary(result.evidence.background_vertex));
  EXPECT_EQ(result.evidence.where, background.position(result.evidence.background_vertex));
}

TEST(UniversalMesh, DoublePositiveFacesAreCountedWhereTheRunSurvivesThem) {
  // A disc two thirds of an edge thick: some faces lie between inside vertices on both of their sides.
  UmParams params = paper();
  params.paper.projection_passes = 1;  // so that the only check for inverted tets comes before any relaxation
  params.paper.relaxation_iterations = 3;
  const AnalyticDomain disc = testing::ellipsoid({1, 1, .03});
  const UmResult result = universal_mesh(BackgroundMesh(a15(), testing::cube_box(1.3), .1), disc, params);
  ASSERT_EQ(result.status, UmStatus::Success) << result.evidence.what;
  EXPECT_GT(result.double_positive_faces, 0u);
  EXPECT_GT(min_quality(result.submesh, result.final), 0);
}

TEST(UniversalMesh, ADoublePositiveFaceWhereTheRunFailsIsTheStatus) {
  // Handles about an edge thick. Rounding decides whether a projection or a tet fails first; both do so at such a face.
  const AnalyticDomain domain = testing::equation_9();
  const UmResult result = universal_mesh(BackgroundMesh(a15(), domain.box, .45), domain, paper());
  ASSERT_EQ(result.status, UmStatus::DoublePositiveFace) << result.evidence.what;
  const BrokenAssumption broken = double_positive_faces(result.submesh);
  EXPECT_EQ(result.double_positive_faces, broken.count);
  EXPECT_GT(result.evidence.count, 0u);
  const auto local = [](const std::vector<std::int64_t>& ids, std::int64_t id) {
    return static_cast<int>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
  };
  if (result.evidence.background_tet >= 0) {
    const Tet& tet = result.submesh.mesh.C[local(result.submesh.background_tet, result.evidence.background_tet)];
    EXPECT_LE(mean_ratio({result.final, {}}, tet), 0);
    EXPECT_TRUE(broken.is_broken_at(tet));
  } else {
    const int i = local(result.submesh.background_vertex, result.evidence.background_vertex);
    EXPECT_EQ(result.evidence.where, result.final[i]);
    EXPECT_TRUE(broken.is_broken_at(std::array{i}));
  }
}

TEST(UniversalMesh, ADiscTooThinToProjectOntoNamesThePlace) {
  // Three tenths of an edge thick, with a rim of curvature 1 / .0009: vertices beside the rim do not find it.
  const AnalyticDomain disc = testing::ellipsoid({1, 1, .03});
  const BackgroundMesh background(a15(), testing::cube_box(1.3), .2);
  const UmResult result = universal_mesh(background, disc, paper());
  ASSERT_EQ(result.status, UmStatus::ProjectionDiverged);
  EXPECT_GT(result.double_positive_faces, 0u);
  EXPECT_EQ(result.evidence.where, background.position(result.evidence.background_vertex));  // nothing has moved yet
  std::vector<std::int64_t> lost;
  for (const int i : result.submesh.positive_vertices) {
    if (closest_point(disc, result.submesh.mesh.V[i], .2, {}).converged) continue;
    lost.push_back(result.submesh.background_vertex[i]);
    const Vec3& x = result.submesh.mesh.V[i];
    EXPECT_GT(std::hypot(x.x(), x.y()), 1);
  }
  ASSERT_EQ(result.evidence.count, lost.size());
  EXPECT_EQ(result.evidence.background_vertex, lost.front());
  EXPECT_EQ(result.final, result.submesh.mesh.V);
  EXPECT_EQ(result.projected, result.submesh.mesh.V);
}

TEST(UniversalMesh, ADivergedProjectionNamesItsVertex) {
  UmParams params = paper();
  params.paper.closest_point.method = ClosestPointMethod::Paper;
  params.paper.closest_point.max_iterations = 1;  // no vertex is on the boundary to begin with
  const AnalyticDomain ball = testing::sphere();
  const UmResult result = mesh_of(ball, 3000, params);
  EXPECT_EQ(result.status, UmStatus::ProjectionDiverged);
  EXPECT_EQ(result.evidence.count, result.submesh.positive_vertices.size());
  EXPECT_GE(ball.value(result.evidence.where), 0);
  EXPECT_GE(result.evidence.background_vertex, 0);
}

TEST(UniversalMesh, AnInvertedIterateNamesItsTet) {
  UmParams params = paper();
  params.paper.projection_passes = 1;  // in one go, which is what the passes are there to avoid
  const UmResult result = mesh_of(testing::banchoff_chmutov_4(), 20000, params);
  ASSERT_EQ(result.status, UmStatus::InvertedTet);
  EXPECT_GE(result.evidence.background_tet, 0);
  EXPECT_LE(min_quality(result.submesh, result.final), 0);
}

TEST(UniversalMesh, TheContextSeesEverySweepAndCanCancel) {
  // The number of polls is that of the calling thread's share of the work.
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  UmParams params = paper();
  params.paper.relaxation_iterations = 3;
  params.paper.projection_passes = 2;
  params.paper.keep_iterates = true;
  const AnalyticDomain ball = testing::sphere();
  const BackgroundMesh background(a15(), ball.box, .3);
  std::vector<std::string> seen;
  double last = 0;
  std::size_t n_polls = 0;
  const Context sees{.progress =
                         [&](const char* step, double fraction) {
                           seen.emplace_back(step);
                           EXPECT_GE(fraction, last);
                           last = fraction;
                         },
                     .cancelled = [&] { return ++n_polls == 0; }};
  const UmResult whole = universal_mesh(background, ball, params, sees);
  EXPECT_EQ(whole.status, UmStatus::Success);
  EXPECT_EQ(last, 1);
  const std::vector<std::string> steps = {"search",  "submesh", "project", "project", "project", "project", "project",
                                          "project", "project", "project", "relax",   "relax",   "relax"};
  EXPECT_EQ(seen, steps);
  ASSERT_EQ(whole.iterates.size(), 2u);
  EXPECT_EQ(whole.iterates[1], whole.projected);
  EXPECT_NE(whole.iterates[0], whole.projected);
  for (std::size_t stop = 0; stop < n_polls; ++stop) {
    std::size_t polls = 0;
    const Context cancels{.cancelled = [&] { return polls++ == stop; }};
    EXPECT_THROW(universal_mesh(background, ball, params, cancels), Cancelled);
    EXPECT_EQ(polls, stop + 1);
  }
}

TEST(UniversalMesh, IsItsTwoSteps) {
  const AnalyticDomain ball = testing::sphere();
  const BackgroundMesh background(a15(), ball.box, .3);
  for (const UmMode mode : {UmMode::Fast, UmMode::Paper}) {
    UmParams params;
    params.mode = mode;
    params.paper.relaxation_iterations = 2;
    ChosenSubmesh chosen = choose_submesh(background, ball, params);
    ASSERT_EQ(chosen.status, UmStatus::Success) << chosen.evidence.what;
    const std::size_t n_tets = chosen.n_tets;
    EXPECT_GT(chosen.submesh.mesh.V.size(), 100u);
    const UmResult fitted = fit_submesh(background, ball, params, std::move(chosen));
    const UmResult whole = universal_mesh(background, ball, params);
    EXPECT_EQ(fitted.final, whole.final);
    EXPECT_EQ(fitted.n_psi_evaluations, whole.n_psi_evaluations);
    EXPECT_NEAR(static_cast<double>(fitted.submesh.mesh.C.size()) / static_cast<double>(n_tets), 1, .02);
  }
  const BackgroundMesh small(a15(), testing::cube_box(.8), .2);
  ChosenSubmesh none = choose_submesh(small, ball);
  EXPECT_EQ(none.status, UmStatus::DomainLeavesBackground);
  EXPECT_EQ(none.n_tets, 0u);
  EXPECT_EQ(fit_submesh(small, ball, {}, std::move(none)).status, UmStatus::DomainLeavesBackground);
}

TEST(UniversalMesh, BrokenParamsAreAllNamed) {
  UmParams params;
  EXPECT_TRUE(problems(params).empty());
  params.paper.projection_passes = 0;
  params.paper.relaxation_iterations = -1;
  params.paper.samples = 0;
  params.paper.closest_point.tol = 0;
  EXPECT_EQ(problems(params).size(), 4u);
  params.submesh.search = SubmeshSearch::Crawl;
  const AnalyticDomain ball = testing::sphere();
  const BackgroundMesh background(a15(), ball.box, .5);
  try {
    universal_mesh(background, ball, params);
    FAIL() << "no exception";
  } catch (const std::invalid_argument& error) {
    for (const char* name : {"projection_passes", "relaxation_iterations", "samples", "closest_point.tol", "seeds"}) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << name;
    }
  }
}

}  // namespace
}  // namespace umtet
