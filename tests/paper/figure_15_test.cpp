// Figs. 14 and 15: eq. (9) in four background meshes, Section 3.6.

#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "mesh/sizes/body_size.h"
#include "mesh/universal_mesh.h"
#include "tests/support/certified.h"
#include "tests/support/domains.h"

using namespace umtet;
namespace domains = umtet::testing;

TEST(Figure15, LeastQualityInFourBackgrounds) {
  struct Bar {
    const char* tiling;
    double floor, paper;  // of the least mean ratio
    double greatest_deg;  // dihedral angle of the tiling, which no conditioning angle exceeds
  };
  std::printf("Eq. (9), 100k tets   h       ours    paper   conditioning angles up to\n");
  for (const Bar& bar : {Bar{"a15", .75, .645, 78.47}, Bar{"z", .75, .667, 77.08}, Bar{"slab", .69, .600, 77.91},
                         Bar{"cube", .53, .394, 87.19}}) {
    SCOPED_TRACE(bar.tiling);
    const auto domain = domains::equation_9();
    const Tiling& tiling = tiling_named(bar.tiling);
    const double h = h_for_tets(tiling, domain, domain.box, 100000);
    const UmResult r = universal_mesh(BackgroundMesh(tiling, domain.box, h), domain, {.mode = UmMode::Paper});
    ASSERT_EQ(r.status, UmStatus::Success) << r.evidence.what;
    const MeshCertificate c = domains::certificate_of(r, domain, h);
    std::printf("  %-4s  %7zu tets   %.4f  %.3f   %.3f   %.2f\n", bar.tiling, r.submesh.mesh.C.size(), h, c.quality.min,
                bar.paper, r.conditioning_angle_max_deg);
    for (const std::string& reason : failures(c)) ADD_FAILURE() << reason;
    EXPECT_GE(c.quality.min, bar.floor);
    EXPECT_EQ(r.obtuse_conditioning_angles, 0u);
    EXPECT_GT(r.conditioning_angle_max_deg, bar.greatest_deg - 2);
    EXPECT_LT(r.conditioning_angle_max_deg, bar.greatest_deg + .01);
    EXPECT_EQ(c.boundary.components, domain.components);
    EXPECT_EQ(c.boundary.genus, domain.genus);
  }
}

TEST(Figure15, FastModeIsBetterInEveryBackground) {
  struct Bar {
    const char* tiling;
    double floor, of_paper_mode, of_tiling;  // least mean ratios
  };
  std::printf("Eq. (9), 100k tets   fast   paper mode   the tiling's own\n");
  for (const Bar& bar : {Bar{"a15", .83, .766, .9449}, Bar{"z", .83, .768, .9608}, Bar{"slab", .78, .707, .9060},
                         Bar{"cube", .62, .560, .6260}}) {
    SCOPED_TRACE(bar.tiling);
    const auto domain = domains::equation_9();
    const Tiling& tiling = tiling_named(bar.tiling);
    const double h = h_for_tets(tiling, domain, domain.box, 100000);
    const UmResult r = universal_mesh(BackgroundMesh(tiling, domain.box, h), domain);
    ASSERT_EQ(r.status, UmStatus::Success) << r.evidence.what;
    const MeshCertificate c = domains::certificate_of(r, domain, h);
    std::printf("  %-4s               %.4f   %.3f        %.3f\n", bar.tiling, c.quality.min, bar.of_paper_mode,
                bar.of_tiling);
    for (const std::string& reason : failures(c)) ADD_FAILURE() << reason;
    EXPECT_GE(c.quality.min, bar.floor);
    EXPECT_GE(c.quality.min, bar.of_paper_mode + .04);
    EXPECT_EQ(c.boundary.genus, domain.genus);
  }
}
