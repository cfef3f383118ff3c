// Section 3: the least quality of meshes of implicit domains, at a size where it has settled; and that of fast mode.

#include <gtest/gtest.h>

#include <cstdio>

#include "mesh/sizes/body_size.h"
#include "mesh/universal_mesh.h"
#include "tests/support/bench_domains.h"
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
    const UmResult r = universal_mesh(BackgroundMesh(a15(), domain.box, h), domain, {.mode = UmMode::Paper});
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

TEST(LeastQuality, DoesNotDependOnWhereTheLatticeLies) {
  const domains::AnalyticDomain domain = domains::banchoff_chmutov_6();
  const double h = h_for_tets(domain, domain.box, 100000, ClassificationSource::Chosen);
  const double cell = h / a15().mean_edge;
  const Box padded(domain.box.min() - Vec3::Constant(cell), domain.box.max() + Vec3::Constant(cell));
  for (int place = 0; place < 8; ++place) {
    SCOPED_TRACE(place);
    // Parts of a cell that fill it evenly: multiples of powers of 1 / x, x^4 = x + 1. The lattice is centred in its
    // box.
    const Vec3 part = Vec3(.8191725, .6710436, .5497005) * place;
    Box box = padded;
    box.translate(cell * Vec3(part - part.array().floor().matrix()));
    const UmResult r = universal_mesh(BackgroundMesh(a15(), box, h), domain);
    ASSERT_EQ(r.status, UmStatus::Success) << r.evidence.what;
    const MeshCertificate c = domains::certificate_of(r, domain, h);
    for (const std::string& reason : failures(c)) ADD_FAILURE() << reason;
    EXPECT_EQ(c.boundary.genus, domain.genus);
    EXPECT_GE(c.quality.min, .83);
    EXPECT_GE(c.quality.p01, .84);
    EXPECT_GE(c.quality.dihedral_min_deg, 35);
    EXPECT_LE(c.quality.dihedral_max_deg, 116);
  }
}
