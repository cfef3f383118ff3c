#include "mesh/fast/repair/step_back.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "mesh/certify/certificate.h"
#include "mesh/core/orientation.h"
#include "mesh/embedding/self_intersections.h"
#include "mesh/universal_mesh.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

using testing::AnalyticDomain;

constexpr double kH = .25;

/// Two unit balls with a gap between them.
AnalyticDomain two_balls(double gap) {
  const Vec3 c(1 + gap / 2, 0, 0);
  return {"two balls",
          Box(Vec3(-2.6, -1.5, -1.5), Vec3(2.6, 1.5, 1.5)),
          2,
          0,
          {},
          {},
          [c](const Vec3& x, Vec3* g, Mat3* H) {
            const Vec3 d = x - (x.x() > 0 ? c : -c);
            if (g) *g = 2 * d;
            if (H) *H = 2 * Mat3::Identity();
            return d.squaredNorm() - 1;
          }};
}

std::size_t n_inverted(const Submesh& submesh, const std::vector<Vec3>& V) {
  return static_cast<std::size_t>(std::count_if(submesh.mesh.C.begin(), submesh.mesh.C.end(), [&](const Tet& t) {
    return orientation_sign(V[t[0]], V[t[1]], V[t[2]], V[t[3]]) <= 0;
  }));
}

class StepBack : public ::testing::Test {
 protected:
  const AnalyticDomain domain = two_balls(2 * kH);
  const UmResult made = universal_mesh(BackgroundMesh(a15(), domain.box, kH), domain);
  std::vector<Vec3> V = made.final;
};

TEST_F(StepBack, LeavesAnEmbeddedMeshAsItIs) {
  ASSERT_EQ(made.status, UmStatus::Success);
  const StepBackReport report = step_back(
      made.submesh, {}, [](int) { return kH; }, V);
  EXPECT_EQ(report.n_pairs + report.n_inverted, 0u);
  EXPECT_TRUE(report.vertices.empty());
  EXPECT_EQ(V, made.final);
}

TEST_F(StepBack, FreesSheetsThatPierceEachOther) {
  // One ball in one piece towards the other, a twentieth of an edge too far: all its tets stay as they are.
  for (Vec3& x : V) {
    if (x.x() < 0) x.x() += 2.05 * kH;
  }
  ASSERT_EQ(n_inverted(made.submesh, V), 0u);
  ASSERT_FALSE(self_intersections(V, made.submesh.positive_faces).empty());
  const std::vector<Vec3> before = V;
  const StepBackReport report = step_back(
      made.submesh, {}, [](int) { return kH; }, V);
  EXPECT_GT(report.n_pairs, 0u);
  EXPECT_EQ(report.n_inverted, 0u);
  EXPECT_TRUE(self_intersections(V, made.submesh.positive_faces).empty());
  EXPECT_EQ(n_inverted(made.submesh, V), 0u);
  EXPECT_FALSE(report.vertices.empty());
  EXPECT_LT(report.vertices.size(), 40u);
  for (std::size_t v = 0; v < V.size(); ++v) {
    const bool listed = std::binary_search(report.vertices.begin(), report.vertices.end(), static_cast<int>(v));
    if (!listed) {
      EXPECT_EQ(V[v], before[v]);
    }
    EXPECT_LE((V[v] - before[v]).norm(), .5 * kH);
  }
}

TEST_F(StepBack, PutsTornTetsBackAsFarAsTheBackground) {
  const int v = made.submesh.positive_vertices.front();
  V[v] += Vec3(0, 0, 3 * kH);
  ASSERT_GT(n_inverted(made.submesh, V), 0u);
  const StepBackReport report = step_back(
      made.submesh, {}, [](int) { return kH; }, V);
  EXPECT_GT(report.n_inverted, 0u);
  EXPECT_EQ(n_inverted(made.submesh, V), 0u);
  EXPECT_TRUE(self_intersections(V, made.submesh.positive_faces).empty());
  EXPECT_TRUE(std::binary_search(report.vertices.begin(), report.vertices.end(), v));
}

}  // namespace
}  // namespace umtet
