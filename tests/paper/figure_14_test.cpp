// Fig. 14: what eq. (9) takes of four backgrounds, and the meshes made of that. Small, and in the ordinary run; the
// drawing is tools/docs/figures.py --only 14.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "mesh/certify/boundary_surface.h"
#include "mesh/sizes/body_size.h"
#include "mesh/universal_mesh.h"
#include "tests/support/certified.h"
#include "tests/support/domains.h"

using namespace umtet;
namespace domains = umtet::testing;

namespace {

/// Standard deviation of the volumes of tets, over their mean.
double spread(const std::vector<Tet>& C, const std::vector<Vec3>& V) {
  double sum = 0, squares = 0;
  for (const Tet& t : C) {
    const double v = (V[t[1]] - V[t[0]]).cross(V[t[2]] - V[t[0]]).dot(V[t[3]] - V[t[0]]);
    sum += v;
    squares += v * v;
  }
  const double n = static_cast<double>(C.size()), mean = sum / n;
  return std::sqrt(squares / n - mean * mean) / mean;
}

}  // namespace

TEST(Figure14, MeshesHaveTheSizesOfTheirBackgrounds) {
  struct Background {
    const char* tiling;
    double spread;  // measured of omega_h
  };
  std::printf("Eq. (9), 40k tets   spread of volumes: omega_h, mesh   min Q\n");
  for (const Background& b :
       {Background{"a15", .057}, Background{"z", .112}, Background{"slab", .587}, Background{"cube", 1.68}}) {
    SCOPED_TRACE(b.tiling);
    const auto domain = domains::equation_9();
    const Tiling& tiling = tiling_named(b.tiling);
    const double h = h_for_tets(tiling, domain, domain.box, 40000);
    const BackgroundMesh background(tiling, domain.box, h);
    const UmResult r = universal_mesh(background, domain);
    ASSERT_EQ(r.status, UmStatus::Success) << r.evidence.what;
    const Submesh& omega_h = r.submesh;
    for (std::size_t i = 0; i < omega_h.mesh.V.size(); ++i) {
      ASSERT_EQ(omega_h.mesh.V[i], background.position(omega_h.background_vertex[i]));
    }
    // The first row already has the topology of the domain.
    const SurfaceTopology topology = surface_topology(omega_h.mesh.V, omega_h.positive_faces);
    EXPECT_TRUE(topology.closed_manifold);
    EXPECT_EQ(topology.components.size(), 1u);
    EXPECT_EQ(topology.genus, domain.genus);
    const MeshCertificate c = domains::certificate_of(r, domain, h);
    for (const std::string& reason : failures(c)) ADD_FAILURE() << reason;
    const double before = spread(omega_h.mesh.C, omega_h.mesh.V), after = spread(omega_h.mesh.C, r.final);
    std::printf("  %-4s %8zu tets   %.3f   %.3f   %.3f\n", b.tiling, omega_h.mesh.C.size(), before, after,
                c.quality.min);
    EXPECT_NEAR(before, b.spread, .1 * b.spread);
    EXPECT_GT(after, .8 * before);
    EXPECT_LT(after, before + .2);
  }
}
