// Certificates of meshes of several regions that anybody has made.

#include "mesh/regions/region_certificate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/tet_shapes.h"

namespace umtet {
namespace {

constexpr std::size_t kTetsOfACube = 6;

TEST(RegionCertificate, MoreRegionsThanADomainHas) {
  constexpr int n = 5;
  const TetMesh mesh = testing::cubes(n, [](int, int, int) { return true; });
  std::vector<int> region;
  for (std::size_t t = 0; t < mesh.C.size(); ++t) region.push_back(static_cast<int>(t / kTetsOfACube));
  const RegionCertificate c = certify_regions(mesh, region);
  EXPECT_TRUE(c.whole.is_embedded());
  EXPECT_EQ(c.n_unshared_faces, 0U);
  ASSERT_EQ(c.regions.size(), 125U);
  for (const RegionMeasures& m : c.regions) {
    EXPECT_NEAR(m.certificate.volume, 1, 1e-12);
    EXPECT_EQ(m.n_pieces, 1);
    EXPECT_EQ(m.certificate.boundary.euler_characteristic, 2);
  }
  ASSERT_EQ(c.interfaces.size(), 3U * n * n * (n - 1));
  for (const InterfaceMeasures& m : c.interfaces) {
    EXPECT_EQ(m.n_faces, 2U);
    EXPECT_NEAR(m.area, 1, 1e-12);
  }
  EXPECT_TRUE(failures(c, 125).empty());
  const RegionDomain domain =
      RegionDomain::of_bodies({[](const Vec3& x, Vec3*, Mat3*) { return x.squaredNorm() - 1; }});
  EXPECT_THROW(certify_regions(mesh, region, &domain), std::invalid_argument);
}

TEST(RegionCertificate, RegionsThatTouchWithoutCommonVerticesFail) {
  // The cubes of the two halves have vertices of their own, as parts that were meshed one by one and not merged.
  TetMesh mesh = testing::cubes(2, [](int i, int, int) { return i == 0; });
  const TetMesh half = mesh;
  const auto n = static_cast<int>(half.V.size());
  for (const Vec3& x : half.V) mesh.V.emplace_back(2 - x[0], x[1], x[2]);
  for (const Tet& t : half.C) mesh.C.push_back({t[0] + n, t[1] + n, t[3] + n, t[2] + n});
  std::vector<int> region(mesh.C.size(), 1);
  std::fill(region.begin() + static_cast<std::ptrdiff_t>(half.C.size()), region.end(), 2);
  const RegionCertificate c = certify_regions(mesh, region);
  EXPECT_EQ(c.n_unshared_faces, 2 * 4 * 2U);  // both sides of four squares
  EXPECT_NE(failures(c, 3).back().find("not connected"), std::string::npos);
  // Half as far again they are two bodies apart, and valid.
  for (std::size_t v = static_cast<std::size_t>(n); v < mesh.V.size(); ++v) mesh.V[v].x() += .5;
  const RegionCertificate apart = certify_regions(mesh, region);
  EXPECT_EQ(apart.n_unshared_faces, 0U);
  EXPECT_TRUE(failures(apart, 3).empty());
  EXPECT_EQ(apart.interfaces.size(), 2U);  // of each with region 0
}

}  // namespace
}  // namespace umtet
