#include "mesh/fast/fast_mesh.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <random>

#include "mesh/core/tet_quality.h"
#include "mesh/fast/defects/patch_state.h"
#include "mesh/octree/graded_mesh.h"
#include "mesh/sizes/body_size.h"
#include "tests/support/bench_domains.h"
#include "tests/support/certified.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

using testing::AnalyticDomain;

BackgroundMesh background_of(const AnalyticDomain& domain, double n_tets) {
  return BackgroundMesh(a15(), domain.box, h_for_tets(domain, domain.box, n_tets, ClassificationSource::Chosen));
}

struct Quality {
  double least = 1;
  std::size_t bad = 0;
};
Quality quality(const UmResult& result, const std::vector<Vec3>& V) {
  Quality q;
  for (const Tet& t : result.submesh.mesh.C) {
    const double of_tet = mean_ratio(V[t[0]], V[t[1]], V[t[2]], V[t[3]]);
    q.least = std::min(q.least, of_tet);
    q.bad += of_tet < .82;
  }
  return q;
}

TEST(FastMesh, WorstTetIsAboveTheTargetAndTheCertificatePasses) {
  for (const AnalyticDomain& domain :
       {testing::sphere(), testing::torus(), testing::equation_9(), testing::banchoff_chmutov_4()}) {
    SCOPED_TRACE(domain.name);
    const BackgroundMesh background = background_of(domain, 50000);
    const UmResult result = universal_mesh(background, domain);
    ASSERT_EQ(result.status, UmStatus::Success) << result.evidence.what;
    EXPECT_GE(quality(result, result.final).least, .83);
    EXPECT_GT(quality(result, result.projected).least, 0);
    const MeshCertificate c = testing::certificate_of(result, domain, background.h());
    EXPECT_TRUE(failures(c).empty()) << failures(c).front();
    EXPECT_EQ(c.boundary.genus, domain.genus);
    EXPECT_EQ(c.boundary.components, domain.components);
    EXPECT_EQ(c.boundary.n_cos_below_half, 0u);
    EXPECT_GE(c.quality.p01, .845);
    EXPECT_GE(c.quality.dihedral_min_deg, 35);
    EXPECT_LE(c.quality.dihedral_max_deg, 116);
    EXPECT_LE(*c.boundary.max_vertex_distance_over_h, 1e-10);
    if (domain.volume) {
      EXPECT_NEAR(c.volume / *domain.volume, 1, .005);
    }
  }
}

/// Fine at (0, 0, 1), `growth` times as coarse from a distance of 1.5 on, and coarser away from psi = 0.
BackgroundMesh fine_at_a_pole(const AnalyticDomain& domain, double finest, double growth) {
  Grading grading{.box = domain.box, .finest = finest, .size = [=](const Vec3& centre, double half_width) {
                    const double reach = std::sqrt(3.) * half_width;
                    const double d = std::max(0., (centre - Vec3(0, 0, 1)).norm() - reach - .1);
                    const double on_surface = finest * std::min(1 + (growth - 1) * d / 1.5, growth);
                    const double depth = std::max(0., std::abs(centre.norm() - 1) - reach);
                    return on_surface + .5 * std::max(0., depth - 3 * on_surface);
                  }};
  return BackgroundMesh(GradedMesh(grading));
}

TEST(FastMesh, GradedBackgroundsGiveEmbeddedMeshesOfGoodTets) {
  const AnalyticDomain domain = testing::sphere();
  for (const double growth : {1., 4., 8.}) {
    SCOPED_TRACE(growth);
    const BackgroundMesh background = fine_at_a_pole(domain, .06, growth);
    const UmResult result = universal_mesh(background, domain);
    ASSERT_EQ(result.status, UmStatus::Success) << result.evidence.what;
    const MeshCertificate c = testing::certificate_of(result, domain, background.h());
    EXPECT_TRUE(invalidities(c).empty()) << invalidities(c).front();
    EXPECT_TRUE(c.is_embedded());
    EXPECT_EQ(c.boundary.genus, 0);
    EXPECT_EQ(result.n_stepped_back, 0u);
    EXPECT_LE(*c.boundary.max_vertex_distance_over_h, 1e-8);
    EXPECT_GT(*c.boundary.min_cos_normal, .85);
    // BCC with one size, and with sizes that change along the surface.
    EXPECT_GE(c.quality.min, growth == 1 ? .78 : .755);
    EXPECT_GE(c.quality.p01, .765);
    EXPECT_GE(c.quality.dihedral_min_deg, 28);
    EXPECT_LE(c.quality.dihedral_max_deg, 127);
  }
}

TEST(FastMesh, OnAGradedBackgroundDoesNotDependOnThreads) {
  const AnalyticDomain domain = testing::sphere();
  const auto mesh = [&] { return universal_mesh(fine_at_a_pole(domain, .08, 4), domain); };
  const UmResult many = mesh();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  const UmResult one = mesh();
  EXPECT_EQ(many.submesh.background_vertex, one.submesh.background_vertex);
  EXPECT_EQ(many.submesh.mesh.C, one.submesh.mesh.C);
  EXPECT_EQ(many.final, one.final);
}

TEST(FastMesh, OnlyTheShellMoves) {
  const AnalyticDomain domain = testing::sphere();
  const BackgroundMesh background = background_of(domain, 50000);
  const UmResult result = universal_mesh(background, domain);
  ASSERT_EQ(result.status, UmStatus::Success);
  std::size_t still = 0;
  for (std::size_t v = 0; v < result.final.size(); ++v) {
    EXPECT_EQ(result.submesh.mesh.V[v], background.position(result.submesh.background_vertex[v]));
    const bool moved = result.final[v] != result.submesh.mesh.V[v];
    if (moved) {
      EXPECT_GT(result.final[v].norm(), 1 - 4.5 * background.h());
    }
    still += !moved;
  }
  EXPECT_GT(still, result.final.size() / 3);
}

TEST(FastMesh, DoesNotDependOnThreadsOrOnTheSearch) {
  const AnalyticDomain domain = testing::equation_9();
  const BackgroundMesh background = background_of(domain, 20000);
  UmParams params;
  const auto with = [&](std::size_t n) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, n);
    return universal_mesh(background, domain, params, {}, domain.boundary_seeds);
  };
  const UmResult one = with(1), three = with(3);
  params.submesh.search = SubmeshSearch::Crawl;
  const UmResult crawled = with(2);
  EXPECT_EQ(one.n_psi_evaluations, three.n_psi_evaluations);
  EXPECT_LT(crawled.n_psi_evaluations, one.n_psi_evaluations);
  for (const UmResult* other : {&three, &crawled}) {
    EXPECT_EQ(other->submesh.background_tet, one.submesh.background_tet);
    ASSERT_EQ(other->final.size(), one.final.size());
    EXPECT_EQ(std::memcmp(other->final.data(), one.final.data(), one.final.size() * sizeof(Vec3)), 0);
    EXPECT_EQ(std::memcmp(other->projected.data(), one.projected.data(), one.final.size() * sizeof(Vec3)), 0);
  }
}

/// All of a result, as repair sees it.
PatchState state_of(const UmResult& result, const AnalyticDomain& domain, double h, double target = .82) {
  ActiveLayer whole;
  whole.V = result.final;
  whole.C = result.submesh.mesh.C;
  whole.h = h;
  std::vector<std::uint8_t> inside(whole.V.size(), 1);
  for (const int i : result.submesh.positive_vertices) inside[i] = 0;
  std::size_t n = 0;
  return patch_state(whole, inside, domain, target, n);
}

TEST(FastMesh, RepairMakesNothingWorseAndMendsPoorTetsAndFoldedFaces) {
  std::size_t mended = 0, unturned = 0, unfolded = 0;
  // The discs are thin enough for folds, and for tets that no flip mends.
  const std::vector<std::pair<AnalyticDomain, double>> cases = {
      {testing::equation_9(), 9000}, {testing::ellipsoid({1, .5, .1}), 4000}, {testing::ellipsoid({1, .3, .08}), 3000}};
  for (const auto& [domain, n_tets] : cases) {
    SCOPED_TRACE(domain.name);
    const BackgroundMesh background = background_of(domain, n_tets);
    UmParams params;
    params.fast.repair.max_patches = 150;  // the discs have more that nothing mends
    const UmResult repaired = universal_mesh(background, domain, params);
    params.fast.repair.max_tries = 0;
    const UmResult plain = universal_mesh(background, domain, params);
    ASSERT_EQ(plain.status, UmStatus::Success);
    ASSERT_EQ(repaired.status, UmStatus::Success);
    const PatchState before = state_of(plain, domain, background.h()),
                     after = state_of(repaired, domain, background.h());
    EXPECT_TRUE(after.is_no_worse_than(before));
    mended += before.below_target - after.below_target;
    unturned += before.misaligned - after.misaligned;
    unfolded += before.folded_over - after.folded_over;
    const MeshCertificate c = testing::certificate_of(repaired, domain, background.h());
    EXPECT_TRUE(c.boundary.closed_manifold);
    EXPECT_EQ(c.quality.n_inverted, 0u);
    EXPECT_EQ(c.boundary.genus, domain.genus);
    EXPECT_EQ(c.boundary.n_cos_below_half, after.misaligned);  // by its own projection
  }
  EXPECT_GT(mended, 0u);
  EXPECT_GT(unturned, 0u);
  EXPECT_GT(unfolded, 0u);
}

/// Vertices of A15 up to `size` h away from where they belong.
TetMesh shaken(const BackgroundMesh& lattice, double size) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> away(-size * lattice.h(), size * lattice.h());
  TetMesh mesh;
  for (std::int64_t v = 0; v < lattice.n_vertices(); ++v) {
    mesh.V.push_back(lattice.position(v) + Vec3(away(random), away(random), away(random)));
  }
  for (std::int64_t t = 0; t < lattice.n_tets(); ++t) {
    const std::array<std::int64_t, 4> ids = lattice.tet(t);
    mesh.C.push_back(
        {static_cast<int>(ids[0]), static_cast<int>(ids[1]), static_cast<int>(ids[2]), static_cast<int>(ids[3])});
  }
  return mesh;
}

TEST(FastMesh, PoorTetsOfAStoredBackgroundAreRaisedInsideToo) {
  const AnalyticDomain domain = testing::sphere();
  const BackgroundMesh background(shaken(background_of(domain, 9000), .27));
  const UmResult result = universal_mesh(background, domain);
  ASSERT_EQ(result.status, UmStatus::Success) << result.evidence.what;
  EXPECT_LT(quality(result, result.submesh.mesh.V).least, .4);
  EXPECT_GE(quality(result, result.final).least, .75);
  EXPECT_TRUE(failures(testing::certificate_of(result, domain, background.h())).empty());
}

// In discs where h is too large most patches have a tet below the last target that nothing mends. One disc alone says
// little: rounding decides which flips are tried, and its least Q is up to .004 less or .015 more with rising targets.
TEST(FastMesh, TargetsThatRiseReachMoreThanOneTarget) {
  const auto sum_of_least = [](double target_step) {
    double sum = 0;
    for (const Vec3& axes : {Vec3(1, .4, .05), Vec3(1, .6, .06), Vec3(1, .7, .05), Vec3(1, 1, .07)}) {
      const AnalyticDomain domain = testing::ellipsoid(axes);
      const BackgroundMesh background = background_of(domain, 2000);
      UmParams params;
      params.fast.repair.target_step = target_step;
      sum += state_of(universal_mesh(background, domain, params), domain, background.h()).least;
    }
    return sum;
  };
  EXPECT_GT(sum_of_least(.01), sum_of_least(0) + .015);
}

TEST(FastMesh, PatchesThatAreMendedStayNearARim) {
  const AnalyticDomain domain = testing::ellipsoid({1, 1, .15});
  const BackgroundMesh background = background_of(domain, 20000);
  const auto missed_volume = [&](bool slides, PatchState& state) {
    UmParams params;
    params.fast.repair.slides = slides;
    const UmResult result = universal_mesh(background, domain, params);
    EXPECT_EQ(result.status, UmStatus::Success) << result.evidence.what;
    state = state_of(result, domain, background.h());
    return testing::certificate_of(result, domain, background.h()).boundary.gap_over_volume.value();
  };
  PatchState held, slid;
  const double without = missed_volume(false, held), with = missed_volume(true, slid);
  EXPECT_LT(with, .97 * without);
  EXPECT_TRUE(slid.is_no_worse_than(held));
}

TEST(FastMesh, AllVerticesAtOnceRaiseWhatSingleOnesCannot) {
  const AnalyticDomain domain = testing::banchoff_chmutov_6();
  const BackgroundMesh background = background_of(domain, 100000);
  const auto least = [&](bool all_vertices) {
    UmParams params;
    params.fast.set_quality_target(.845);
    params.fast.repair.all_vertices = all_vertices;
    return state_of(universal_mesh(background, domain, params), domain, background.h()).least;
  };
  EXPECT_LT(least(false), .84);
  EXPECT_GE(least(true), .845);
}

// 31 tets below the target, many mended at once: those of one round must be far enough from each other.
TEST(FastMesh, TetsThatAreMendedAtOnceDoNotMeet) {
  const AnalyticDomain domain = testing::banchoff_chmutov_6();
  const BackgroundMesh background = background_of(domain, 100000);
  const auto with = [&](std::size_t n) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, n);
    return universal_mesh(background, domain);
  };
  const UmResult one = with(1), three = with(3);
  ASSERT_EQ(one.status, UmStatus::Success) << one.evidence.what;
  EXPECT_TRUE(failures(testing::certificate_of(one, domain, background.h())).empty());
  EXPECT_GE(quality(one, one.final).least, .83);
  EXPECT_EQ(one.n_psi_evaluations, three.n_psi_evaluations);
  EXPECT_EQ(one.submesh.background_tet, three.submesh.background_tet);
  ASSERT_EQ(one.final.size(), three.final.size());
  EXPECT_EQ(std::memcmp(one.final.data(), three.final.data(), one.final.size() * sizeof(Vec3)), 0);
}

// The last of its tets below the target needs a pair of flips whose patch first has more tets below the target, and
// none after ten sweeps: a trial that is given up too early loses it.
TEST(FastMesh, RepairWaitsForPatchesThatGetWorseFirst) {
  const AnalyticDomain domain = testing::equation_9();
  const UmResult result = universal_mesh(background_of(domain, 500000), domain);
  ASSERT_EQ(result.status, UmStatus::Success) << result.evidence.what;
  EXPECT_GE(quality(result, result.final).least, .83);
}

TEST(FastMesh, WhatIsAboveTheTargetIsLiftedWhereItMay) {
  const AnalyticDomain domain = testing::banchoff_chmutov_6();
  const BackgroundMesh background = background_of(domain, 50000);
  UmParams params;
  params.fast.repair.lift = 0;
  const UmResult low = universal_mesh(background, domain, params), lifted = universal_mesh(background, domain);
  EXPECT_LT(quality(low, low.final).least, .825);
  EXPECT_GE(quality(lifted, lifted.final).least, .83);
  EXPECT_EQ(testing::certificate_of(lifted, domain, background.h()).boundary.genus, domain.genus);
  // Where h hardly shows the body few patches are tried: what is not lifted stays above the target.
  const BackgroundMesh coarse = background_of(domain, 20000);
  const UmResult some = universal_mesh(coarse, domain);
  EXPECT_GE(quality(some, some.final).least, .82);
}

TEST(FastMesh, WhatCannotBeMeshedIsAStatusWithEvidence) {
  const UmResult empty =
      universal_mesh(BackgroundMesh(a15(), Box(Vec3(3, 3, 3), Vec3(4, 4, 4)), .2), testing::sphere());
  EXPECT_EQ(empty.status, UmStatus::EmptyDomain);
  EXPECT_FALSE(empty.evidence.what.empty());

  const BackgroundMesh small(a15(), testing::cube_box(.8), .2);
  const UmResult out = universal_mesh(small, testing::sphere());
  EXPECT_EQ(out.status, UmStatus::DomainLeavesBackground);
  EXPECT_GT(out.evidence.count, 0u);
  EXPECT_TRUE(small.on_boundary(out.evidence.background_vertex));
  EXPECT_EQ(out.final.size(), out.submesh.mesh.V.size());
}

TEST(FastMesh, WhatIsTooThinIsAValidMesh) {
  const AnalyticDomain disc = testing::ellipsoid({1, 1, .01});  // a tenth of an edge thick
  const BackgroundMesh background(a15(), testing::cube_box(1.3), .2);
  const UmResult thin = universal_mesh(background, disc);
  ASSERT_EQ(thin.status, UmStatus::Success) << thin.evidence.what;
  const MeshCertificate c = testing::certificate_of(thin, disc, background.h());
  EXPECT_EQ(c.quality.n_inverted, 0u);
  EXPECT_TRUE(c.boundary.closed_manifold);
  // Whether all of them arrive depends on the last bits, and so on the compiler.
  EXPECT_LT(c.boundary.max_vertex_distance_over_h, .5);
}

TEST(FastMesh, TheContextCanCancelItAnywhere) {
  // The number of polls is that of the calling thread's share of the work.
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const AnalyticDomain domain = testing::equation_9();
  const BackgroundMesh background = background_of(domain, 9000);
  std::size_t n_polls = 0;
  double last = 0;
  const Context sees{.progress =
                         [&](const char*, double fraction) {
                           EXPECT_GE(fraction, last);
                           last = fraction;
                         },
                     .cancelled = [&] { return ++n_polls == 0; }};
  EXPECT_EQ(universal_mesh(background, domain, {}, sees).status, UmStatus::Success);
  EXPECT_EQ(last, 1);
  ASSERT_GT(n_polls, 3u);
  for (std::size_t stop = 0; stop < n_polls; stop += std::max<std::size_t>(1, n_polls / 7)) {
    std::size_t polls = 0;
    EXPECT_THROW(universal_mesh(background, domain, {}, {.cancelled = [&] { return polls++ == stop; }}), Cancelled);
    EXPECT_EQ(polls, stop + 1);
  }
}

TEST(FastMesh, BrokenParamsAreAllNamed) {
  UmParams params;
  params.fast.layers = 0;
  params.fast.classification.shift = 1;
  params.fast.repair.reach = 0;
  params.fast.repair.target_step = -1;
  params.fast.update_margin = -1;
  EXPECT_EQ(problems(params).size(), 5u);
}

}  // namespace
}  // namespace umtet
