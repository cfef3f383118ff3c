// Figs. 20 and 21B: eq. (13) at some of its 44 instants, in one background mesh. All of them: docs/using.md, `umtet evolve`.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "mesh/certify/certificate.h"
#include "mesh/universal_mesh.h"
#include "tests/support/certified.h"
#include "tests/support/domains.h"

using namespace umtet;
namespace domains = umtet::testing;

TEST(Figure21, OneBackgroundServesADomainThatFallsApartAndJoinsAgain) {
  struct Instant {
    double t;
    int components, genus;
  };
  const Tiling& tiling = a15();
  const double h = .16 * tiling.mean_edge / tiling.period[0];  // cells of edge .16
  const BackgroundMesh background(tiling, domains::cube_box(2.1), h);
  double worst = 1;
  std::printf("Eq. (13), h = %.4f    tets   min Q\n", h);
  for (const Instant& at : {Instant{0, 1, 0}, Instant{1.5, 1, 0}, Instant{3, 1, 0}, Instant{3.2, 4, 0},
                            Instant{3.3, 4, 0}, Instant{3.5, 1, 3}, Instant{4.1, 2, 3}, Instant{4.5, 8, 3}}) {
    SCOPED_TRACE(at.t);
    const auto domain = domains::equation_13(at.t);
    const UmResult r = universal_mesh(background, domain);
    ASSERT_EQ(r.status, UmStatus::Success) << r.evidence.what;
    const MeshCertificate c = umtet::testing::certificate_of(r, domain, h);
    std::printf("  t = %.1f        %8zu   %.4f\n", at.t, r.submesh.mesh.C.size(), c.quality.min);
    for (const std::string& reason : failures(c)) ADD_FAILURE() << reason;
    EXPECT_EQ(c.boundary.components, at.components);
    EXPECT_EQ(c.boundary.genus, at.genus);
    worst = std::min(worst, c.quality.min);
  }
  std::printf("  worst %.4f; the paper, over all 44: .615\n", worst);
  EXPECT_GE(worst, .815);
}
