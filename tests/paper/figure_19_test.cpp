// Fig. 19 and 21A: the bird, moved by eq. (12), in one background mesh. All instants of a period:
// examples/swimmer/bird.py.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "mesh/universal_mesh.h"
#include "reconstruct/io/point_cloud_io.h"
#include "reconstruct/solve/fit_ssd.h"
#include "tests/support/certified.h"
#include "tests/support/data_files.h"

using namespace umtet;

namespace {

/// Eq. (12). Normals move by F^-T n = n - n_y g, g the gradient of the displacement along y.
OrientedPointCloud moved(OrientedPointCloud cloud, double t) {
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    Vec3 &x = cloud.points[i], &n = cloud.normals[i];
    n += n.y() * Vec3(.8 * std::sin(x.x()) * std::sin(t), 0, -.1 * std::cos(x.z()) * std::cos(t));
    n.normalize();
    x.y() += .8 * (std::cos(x.x()) - 1) * std::sin(t) + .1 * std::sin(x.z()) * std::cos(t);
  }
  return cloud;
}

}  // namespace

TEST(Figure19, OneBackgroundServesABirdInFlight) {
  const OrientedPointCloud bird = read_point_cloud(test::committed_cloud("bird.ply")).cloud;
  std::vector<LevelSet> psi;
  Box box;
  for (const double t : {0., 1.6, 3.2, 4.8}) {
    psi.push_back(fit_ssd(moved(bird, t)).psi);
    box.extend(psi.back().domain());
  }
  const double h = .0724;  // what `umtet evolve` chooses
  const BackgroundMesh background(a15(), box, h);
  std::printf("The bird, h = %.4f   tets   min Q   (the paper, at worst: .657)\n", h);
  for (const LevelSet& fitted : psi) {
    const LevelSet f = fitted.band_limited(.7 * h);
    const UmResult r = universal_mesh(background, f);
    ASSERT_EQ(r.status, UmStatus::Success) << r.evidence.what;
    const MeshCertificate c = umtet::testing::certificate_of(r, f, h);
    for (const std::string& reason : failures(c)) ADD_FAILURE() << reason;
    std::printf("  %24zu   %.3f\n", r.submesh.mesh.C.size(), c.quality.min);
    EXPECT_EQ(c.boundary.components, 1);
    EXPECT_EQ(c.boundary.genus, 0);
    EXPECT_GE(c.quality.min, .81);
  }
}
