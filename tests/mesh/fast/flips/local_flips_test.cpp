#include "mesh/fast/flips/local_flips.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "mesh/core/tet_quality.h"
#include "mesh/fast/flips/flipped_submesh.h"
#include "mesh/octree/graded_mesh.h"
#include "tests/support/certified.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

using testing::AnalyticDomain;

/// Eight times as fine at one end of the x axis as at the other; no repair.
struct GradedBall {
  AnalyticDomain ball = testing::sphere();
  UmResult result;
  double h = .045;

  GradedBall() {
    const Grading grading{.box = ball.box, .finest = h, .size = [this](const Vec3& x, double half_width) {
                            const double d = (x - Vec3::UnitX()).norm() - std::sqrt(3.) * half_width;
                            return h + .16 * std::max(0., d);
                          }};
    UmParams params;
    params.fast.flips_follow = true;
    result = universal_mesh(BackgroundMesh(GradedMesh(grading)), ball, params);
  }
  std::vector<VertexStratum> strata() const {
    std::vector<VertexStratum> all(result.final.size(), VertexStratum::Inner);
    for (const int v : result.submesh.positive_vertices) all[v] = VertexStratum::Boundary;
    return all;
  }
};

double least_quality(const std::vector<Vec3>& V, const std::vector<Tet>& C) {
  double least = 1;
  for (const Tet& t : C) least = std::min(least, mean_ratio(V[t[0]], V[t[1]], V[t[2]], V[t[3]]));
  return least;
}

double volume(const std::vector<Vec3>& V, const std::vector<Tet>& C) {
  double sum = 0;
  for (const Tet& t : C) sum += volume6(V[t[0]], V[t[1]], V[t[2]], V[t[3]]) / 6;
  return sum;
}

TEST(LocalFlips, RaiseTheWorstTetsOfAGradedMeshThatStaysValid) {
  GradedBall made;
  ASSERT_EQ(made.result.status, UmStatus::Success);
  const double before = least_quality(made.result.final, made.result.submesh.mesh.C);
  const LocalFlipReport report = flip_submesh(made.ball, made.h, {}, made.result);
  EXPECT_GT(report.n_removed_edges, 0U);
  EXPECT_GT(report.n_collapsed, 0U);
  const double after = least_quality(made.result.final, made.result.submesh.mesh.C);
  EXPECT_LT(before, .75);
  EXPECT_GE(after, LocalFlipParams().target);
  EXPECT_EQ(report.n_below, 0U);
  const MeshCertificate certificate = testing::certificate_of(made.result, made.ball, made.h);
  EXPECT_TRUE(failures(certificate).empty()) << failures(certificate).front();
  EXPECT_NEAR(volume(made.result.final, made.result.submesh.mesh.C), *made.ball.volume, .01 * *made.ball.volume);
}

TEST(LocalFlips, TheSubmeshSaysWhichTetsAreTheBackgrounds) {
  GradedBall made;
  const Submesh before = made.result.submesh;
  flip_submesh(made.ball, made.h, {}, made.result);
  const Submesh& after = made.result.submesh;
  ASSERT_TRUE(made.result.of_background);
  EXPECT_EQ(made.result.of_background->submesh.mesh.C, before.mesh.C);
  std::map<std::int64_t, std::set<std::int64_t>> corners;
  for (std::size_t t = 0; t < before.mesh.C.size(); ++t)
    for (const int v : before.mesh.C[t]) corners[before.background_tet[t]].insert(before.background_vertex[v]);
  std::size_t n_new = 0;
  for (std::size_t t = 0; t < after.mesh.C.size(); ++t) {
    std::set<std::int64_t> ids;
    for (const int v : after.mesh.C[t]) ids.insert(after.background_vertex[v]);
    if (after.background_tet[t] >= 0) {
      EXPECT_EQ(ids, corners.at(after.background_tet[t]));
      EXPECT_EQ(n_new, 0U) << "tets of the background come first";
    } else {
      ++n_new;
    }
  }
  EXPECT_GT(n_new, 0U);
  EXPECT_TRUE(std::is_sorted(after.background_vertex.begin(), after.background_vertex.end()));
  for (std::size_t f = 0; f < after.positive_faces.size(); ++f) {
    const Tet& t = after.mesh.C[after.positive_tets[f]];
    for (const int v : after.positive_faces[f]) EXPECT_NE(std::find(t.begin(), t.end(), v), t.end());
  }
}

TEST(LocalFlips, MakeTheSameMeshAgain) {
  const GradedBall made;
  LocalFlipReport a, b;
  const FlippedMesh one = flip_locally(made.result.final, made.result.submesh.mesh.C, made.strata(), made.ball, {}, a);
  const FlippedMesh two = flip_locally(made.result.final, made.result.submesh.mesh.C, made.strata(), made.ball, {}, b);
  EXPECT_EQ(one.V, two.V);
  EXPECT_EQ(one.C, two.C);
  EXPECT_EQ(a.tries, b.tries);
}

TEST(LocalFlips, LeaveAMeshAloneThatReachesTheTarget) {
  const GradedBall made;
  LocalFlipReport report;
  const FlippedMesh same =
      flip_locally(made.result.final, made.result.submesh.mesh.C, made.strata(), made.ball, {.target = .3}, report);
  EXPECT_EQ(same.V, made.result.final);
  EXPECT_EQ(same.C, made.result.submesh.mesh.C);
  EXPECT_EQ(report.tries, 0U);
}

TEST(LocalFlips, MendOnlyTetsBelowTheBarOfEachPass) {
  const GradedBall made;
  const auto flipped = [&](double first, double last) {
    LocalFlipReport report;
    LocalFlipParams params;
    params.mend_below = first;
    params.mend_below_at_last = last;
    const FlippedMesh mesh =
        flip_locally(made.result.final, made.result.submesh.mesh.C, made.strata(), made.ball, params, report);
    return std::pair(report.tries, least_quality(mesh.V, mesh.C));
  };
  const double least = least_quality(made.result.final, made.result.submesh.mesh.C),
               bar = (least + LocalFlipParams().target) / 2;
  EXPECT_EQ(flipped(.9 * least, .9 * least).first, 0U);
  const auto [few, least_of_few] = flipped(bar, bar);
  const auto [many, least_of_many] = flipped(1, 1);
  EXPECT_GT(few, 0U);
  EXPECT_LT(few, many);
  EXPECT_GE(least_of_few, bar);
  EXPECT_GE(least_of_many, LocalFlipParams().target);
  EXPECT_GT(flipped(.9 * least, bar).first, 0U) << "the last pass has a bar of its own";
  EXPECT_GT(flipped(bar, .9 * least).first, 0U) << "and so has the first";
}

TEST(LocalFlips, FixedVerticesStay) {
  const GradedBall made;
  std::vector<VertexStratum> strata = made.strata();
  for (std::size_t v = 0; v < strata.size(); ++v)
    if (made.result.final[v].y() > 0) strata[v] = VertexStratum::Fixed;
  LocalFlipReport report;
  const FlippedMesh flipped =
      flip_locally(made.result.final, made.result.submesh.mesh.C, strata, made.ball, {}, report);
  std::vector<std::uint8_t> is_used(strata.size(), 0);
  for (const Tet& t : flipped.C)
    for (const int v : t) is_used[v] = 1;
  for (std::size_t v = 0; v < strata.size(); ++v) {
    if (strata[v] != VertexStratum::Fixed) continue;
    EXPECT_EQ(flipped.V[v], made.result.final[v]);
    EXPECT_TRUE(is_used[v]);
  }
}

TEST(LocalFlips, AnEdgeBetweenFlatTetsIsRemoved) {
  // Five tets around an edge that is far too short for its ring: six others fill the same double pyramid better.
  std::vector<Vec3> V = {{0, 0, -.8}, {0, 0, .8}};
  constexpr int kRing = 3;
  for (int k = 0; k < kRing; ++k) {
    const double u = 2 * std::numbers::pi * k / kRing;
    V.emplace_back(.6 * std::cos(u), .6 * std::sin(u), 0);
  }
  std::vector<Tet> C;
  for (int k = 0; k < kRing; ++k) C.push_back({0, 1, 2 + k, 2 + (k + 1) % kRing});
  const std::vector<VertexStratum> fixed(V.size(), VertexStratum::Fixed);
  const double before = least_quality(V, C);
  LocalFlipReport report;
  const FlippedMesh made =
      flip_locally(V, C, fixed, testing::sphere(), {.target = .95, .shortest = .1, .longest = 3}, report);
  EXPECT_EQ(made.C.size(), 2U);
  EXPECT_EQ(report.n_removed_edges, 1U);
  EXPECT_GT(least_quality(made.V, made.C), before);
  EXPECT_NEAR(volume(made.V, made.C), volume(V, C), 1e-12);
  EXPECT_EQ(made.origin, (std::vector<std::int64_t>{-1, -1}));
}

TEST(LocalFlips, WrongParametersAreNamed) {
  EXPECT_EQ(problems(LocalFlipParams{.target = 1, .shortest = 2, .longest = .5, .most_candidates = -1}).size(), 4U);
  LocalFlipParams wrong;
  wrong.mend_below = wrong.mend_below_at_last = 0;
  wrong.most_failures = wrong.most_failures_at_last = 0;
  EXPECT_EQ(problems(wrong).size(), 4U);
  LocalFlipReport report;
  EXPECT_THROW(flip_locally({}, {}, {}, testing::sphere(), {.target = 0}, report), std::invalid_argument);
  EXPECT_THROW(flip_locally({Vec3::Zero()}, {}, {}, testing::sphere(), {}, report), std::invalid_argument);
}

TEST(LocalFlips, CanBeCancelled) {
  const GradedBall made;
  LocalFlipReport report;
  const Context context{.cancelled = [] { return true; }};
  EXPECT_THROW(
      flip_locally(made.result.final, made.result.submesh.mesh.C, made.strata(), made.ball, {}, report, context),
      Cancelled);
}

}  // namespace
}  // namespace umtet
