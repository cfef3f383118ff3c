// A mesh in a background that has been refined at one place is the former mesh away from it.

#include "mesh/fast/update/former_mesh.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>

#include "mesh/octree/graded_mesh.h"
#include "mesh/universal_mesh.h"
#include "tests/support/certified.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

using testing::AnalyticDomain;

const Vec3 kPole(0, 0, 1);

/// Edges of .1, and of `at_pole` around the pole, in one root cube for any of them.
BackgroundMesh refined_at_pole(const AnalyticDomain& domain, double at_pole) {
  Grading grading{.box = domain.box, .finest = .025, .size = [=](const Vec3& centre, double half_width) {
                    const double d = (centre - kPole).norm() - std::sqrt(3.) * half_width - .15;
                    return std::min(.1, at_pole + .3 * std::max(0., d));
                  }};
  return BackgroundMesh(GradedMesh(grading));
}

UmResult refined(const BackgroundMesh& background, const AnalyticDomain& domain, const FormerMesh& former) {
  return fit_submesh(background, domain, {}, choose_submesh(background, domain, {}, former));
}

/// Places by the keys of the vertices.
std::map<std::int64_t, Vec3> places(const BackgroundMesh& background, const UmResult& mesh) {
  std::map<std::int64_t, Vec3> at;
  const auto& ids = mesh.submesh.background_vertex;
  for (std::size_t v = 0; v < ids.size(); ++v) at[background.key_of_vertex(ids[v])] = mesh.final[v];
  return at;
}

using TetKey = std::array<std::int64_t, 4>;

/// Tets by the keys of their vertices.
std::set<TetKey> tets_far_from_pole(const BackgroundMesh& background, const UmResult& mesh, double far) {
  std::set<TetKey> keys;
  for (const Tet& tet : mesh.submesh.mesh.C) {
    if ((mesh.final[tet[0]] - kPole).norm() <= far) continue;
    TetKey key;
    for (std::size_t k = 0; k < 4; ++k) key[k] = background.key_of_vertex(mesh.submesh.background_vertex[tet[k]]);
    keys.insert(key);
  }
  return keys;
}

TEST(FormerMesh, StaysAwayFromWhereTheBackgroundIsRefined) {
  const AnalyticDomain domain = testing::sphere();
  const BackgroundMesh coarse = refined_at_pole(domain, .1), fine = refined_at_pole(domain, .05);
  const UmResult before = universal_mesh(coarse, domain);
  ASSERT_EQ(before.status, UmStatus::Success);
  const UmResult after = refined(fine, domain, {coarse, before});
  ASSERT_EQ(after.status, UmStatus::Success) << after.evidence.what;
  ASSERT_GT(after.final.size(), before.final.size());
  constexpr double kFar = 1.4;
  EXPECT_EQ(tets_far_from_pole(coarse, before, kFar), tets_far_from_pole(fine, after, kFar));
  const auto was = places(coarse, before), is = places(fine, after);
  std::size_t n_far = 0, n_moved = 0;
  for (const auto& [key, x] : is) {
    const bool is_far = (x - kPole).norm() > kFar;
    n_far += is_far;
    n_moved += is_far && (was.count(key) == 0 || was.at(key) != x);
  }
  EXPECT_GT(n_far, was.size() / 3);
  EXPECT_EQ(n_moved, 0u);

  const MeshCertificate c = testing::certificate_of(after, domain, .1);
  EXPECT_TRUE(failures(c).empty()) << failures(c).front();
  EXPECT_EQ(c.boundary.genus, 0);
  EXPECT_GE(c.quality.min, .73);
  EXPECT_LE(*c.boundary.max_vertex_distance_over_h, 1e-8);
  // As good as one that is made anew, but for what its worst tet happens to be.
  const UmResult whole = universal_mesh(fine, domain);
  const MeshCertificate anew = testing::certificate_of(whole, domain, .1);
  EXPECT_NEAR(c.quality.p01, anew.quality.p01, .01);
  EXPECT_NEAR(c.quality.mean, anew.quality.mean, .01);
  EXPECT_LT(after.n_psi_evaluations, whole.n_psi_evaluations);
}

TEST(FormerMesh, IsTheMeshWhereNothingIsRefined) {
  const AnalyticDomain domain = testing::torus();
  const BackgroundMesh background = refined_at_pole(domain, .1);
  const UmResult before = universal_mesh(background, domain);
  const UmResult after = refined(background, domain, {background, before});
  EXPECT_EQ(after.submesh.background_tet, before.submesh.background_tet);
  EXPECT_EQ(after.final, before.final);
  EXPECT_EQ(after.projected, before.projected);
  EXPECT_EQ(after.n_psi_evaluations, 0u);
}

/// The unit sphere, and one of .1 over its pole, where the background is refined.
AnalyticDomain two_spheres() {
  AnalyticDomain domain = testing::sphere();
  domain.box = testing::cube_box(1.6);
  domain.psi = [](const Vec3& x, Vec3* g, Mat3* H) {
    const Vec3 off = x - 1.3 * kPole;
    const bool is_small = off.norm() - .1 < x.norm() - 1;
    const Vec3& d = is_small ? off : x;
    const double r = d.norm();
    if (g) *g = d / r;
    if (H) *H = (Mat3::Identity() - d * d.transpose() / (r * r)) / r;
    return r - (is_small ? .1 : 1);
  };
  return domain;
}

TEST(FormerMesh, HasThePiecesWithASeed) {
  const AnalyticDomain domain = two_spheres();
  const BackgroundMesh coarse = refined_at_pole(domain, .1), fine = refined_at_pole(domain, .05);
  UmParams params;
  params.submesh.search = SubmeshSearch::Crawl;
  for (const std::vector<Vec3>& seeds : {std::vector<Vec3>{-kPole}, std::vector<Vec3>{-kPole, 1.2 * kPole}}) {
    const UmResult before = universal_mesh(coarse, domain, params, {}, seeds);
    ASSERT_EQ(before.status, UmStatus::Success) << before.evidence.what;
    const UmResult after =
        fit_submesh(fine, domain, params, choose_submesh(fine, domain, params, FormerMesh{coarse, before, seeds}));
    ASSERT_EQ(after.status, UmStatus::Success) << after.evidence.what;
    ASSERT_GT(after.final.size(), before.final.size());
    const MeshCertificate c = testing::certificate_of(after, domain, .1);
    EXPECT_TRUE(failures(c).empty()) << failures(c).front();
    EXPECT_EQ(c.boundary.components, static_cast<int>(seeds.size()));
  }
}

TEST(FormerMesh, DoesNotDependOnThreads) {
  const AnalyticDomain domain = testing::sphere();
  const BackgroundMesh coarse = refined_at_pole(domain, .1), fine = refined_at_pole(domain, .04);
  const UmResult before = universal_mesh(coarse, domain);
  const UmResult many = refined(fine, domain, {coarse, before});
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  const UmResult one = refined(fine, domain, {coarse, before});
  EXPECT_EQ(many.submesh.background_tet, one.submesh.background_tet);
  EXPECT_EQ(many.final, one.final);
}

TEST(FormerMesh, IsForFastMode) {
  const AnalyticDomain domain = testing::sphere();
  const BackgroundMesh background = refined_at_pole(domain, .1);
  const UmResult before = universal_mesh(background, domain);
  EXPECT_THROW(choose_submesh(background, domain, {.mode = UmMode::Paper}, FormerMesh{background, before}),
               std::invalid_argument);
}

}  // namespace
}  // namespace umtet
