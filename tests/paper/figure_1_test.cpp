// Figures 1, 9 and 10: least quality and angles beside other meshers, which tests/bench/peers/compare.py runs.

#include <gtest/gtest.h>

#include <cstdio>

#include "mesh/sizes/body_size.h"
#include "mesh/universal_mesh.h"
#include "tests/support/bench_domains.h"
#include "tests/support/certified.h"

using namespace umtet;
namespace domains = umtet::testing;

TEST(Figure1, QualityAndAnglesAt100kTets) {
  std::printf(
      "Figure 1, 100k tets     least Q   1 %%  dihedral angles   (paper: .660 .663 .669 .634; TetGen there: .071 to "
      ".086; Gmsh, TetGen and CGAL here: docs/comparison.md)\n");
  for (const auto& domain : {domains::sphere(), domains::torus(), domains::equation_9(), domains::banchoff_chmutov_6(),
                             domains::equation_13(3.2)}) {
    SCOPED_TRACE(domain.name);
    const double h = h_for_tets(domain, domain.box, 100000);
    const UmResult r = universal_mesh(BackgroundMesh(a15(), domain.box, h), domain);
    ASSERT_EQ(r.status, UmStatus::Success) << r.evidence.what;
    const MeshCertificate c = domains::certificate_of(r, domain, h);
    std::printf("  %-20s   %.3f  %.3f   %.1f to %.1f\n", domain.name.c_str(), c.quality.min, c.quality.p01,
                c.quality.dihedral_min_deg, c.quality.dihedral_max_deg);
    for (const std::string& reason : failures(c)) ADD_FAILURE() << reason;
    EXPECT_GE(c.quality.min, .81);
    EXPECT_GE(c.quality.p01, .83);
    EXPECT_GE(c.quality.dihedral_min_deg, 34);
    EXPECT_LE(c.quality.dihedral_max_deg, 118);
    EXPECT_EQ(c.boundary.components, domain.components);
    EXPECT_EQ(c.boundary.genus, domain.genus);
  }
}
