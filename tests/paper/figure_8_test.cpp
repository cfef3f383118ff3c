// Figure 8: the quality vectors of the duck's mesh at three stages of Algorithm 1.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "mesh/certify/quality_report.h"
#include "mesh/sizes/body_size.h"
#include "mesh/universal_mesh.h"
#include "reconstruct/io/point_cloud_io.h"
#include "reconstruct/solve/fit_ssd.h"
#include "tests/support/data_files.h"

using namespace umtet;

TEST(Figure8, QualitiesAtThreeStages) {
  const OrientedPointCloud cloud = read_point_cloud(test::duck_cloud()).cloud;
  ASSERT_EQ(cloud.points.size(), 5344u);
  const LevelSet psi = fit_ssd(cloud).psi;
  const ImplicitFunctionRef f(psi);
  const BackgroundMesh background(a15(), psi.domain(), h_for_tets(f, psi.domain(), 60000));
  const UmResult r = universal_mesh(background, f, {.mode = UmMode::Paper});
  ASSERT_EQ(r.status, UmStatus::Success) << r.evidence.what;

  const std::vector<Tet>& C = r.submesh.mesh.C;
  const auto vectors = [&](const std::vector<Vec3>& V) {
    return quality_vectors(C, mean_ratios({V, C}), r.submesh.positive_vertices, V.size());
  };
  const std::vector<double> background_Q = vectors(r.submesh.mesh.V).all;
  const auto [projected, projected_b] = vectors(r.projected);
  const auto [final, final_b] = vectors(r.final);
  std::printf("Figure 8 (duck, %zu tets)  least Q   1%% of Q vector\n", C.size());
  std::printf("  omega_h                 %.3f     %.3f   (paper: that of the background, about .945)\n",
              background_Q.front(), quantile(background_Q, 0.01));
  std::printf("  after projection        %.3f     %.3f   (paper: noticeably poorer, none zero or negative)\n",
              projected.front(), quantile(projected, 0.01));
  std::printf("  final                   %.3f     %.3f   (paper, other scans: .660 .663 .669 .634)\n", final.front(),
              quantile(final, 0.01));

  EXPECT_GE(background_Q.front(), 0.9449);
  EXPECT_GT(projected.front(), 0.3);
  EXPECT_LT(projected.front(), background_Q.front());
  EXPECT_GE(final.front(), 0.70);
  // Section 3.4: the poorest tets of the projected mesh have a positive vertex, and boundary dvr improves just those.
  EXPECT_EQ(projected_b.front(), projected.front());
  EXPECT_GT(final_b.front(), projected_b.front());
  EXPECT_GT(quantile(final_b, 0.1), quantile(projected_b, 0.1));
}
