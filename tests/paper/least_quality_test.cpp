// Section 3: the least quality of meshes of implicit domains, at a size where it has settled.

#include <gtest/gtest.h>

#include <cstdio>

#include "mesh/universal_mesh.h"
#include "tests/support/certified.h"
#include "tests/support/domains.h"

using namespace umtet;
namespace domains = umtet::testing;

namespace {

struct Bar {
  domains::AnalyticDomain domain;
  double floor;  // of the least mean ratio
  const char* paper;
};

}  // namespace

TEST(LeastQuality, OfImplicitDomainsAt100kTets) {
  std::printf("Least Q at 100k tets             ours    paper\n");
  for (const Bar& bar : {Bar{domains::sphere(), .75, ""}, Bar{domains::torus(), .75, ""},
                         Bar{domains::equation_9(), .74, ".645 (Fig. 15, stencil 1)"},
                         Bar{domains::equation_13(3.2), .74, ".615 (Fig. 21B, worst of all t)"}}) {
    const domains::AnalyticDomain& domain = bar.domain;
    SCOPED_TRACE(domain.name);
    const double h = h_for_tets(domain, domain.box, 100000);
    const UmResult r = universal_mesh(BackgroundMesh(a15(), domain.box, h), domain);
    ASSERT_EQ(r.status, UmStatus::Success) << r.evidence.what;
    const MeshCertificate c = domains::certificate_of(r, domain, h);
    std::printf("  %-20s %7zu tets   %.3f   %s\n", domain.name.c_str(), r.submesh.mesh.C.size(), c.quality.min,
                bar.paper);
    for (const std::string& reason : failures(c)) ADD_FAILURE() << reason;
    EXPECT_GE(c.quality.min, bar.floor);
    EXPECT_EQ(c.boundary.components, domain.components);
    EXPECT_EQ(c.boundary.genus, domain.genus);
    EXPECT_LT(*c.boundary.max_vertex_distance_over_h, 1e-8);
  }
}
