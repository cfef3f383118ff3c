#include "mesh/submesh/walls.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstdio>
#include <numbers>
#include <vector>

#include "mesh/background/a15_box.h"
#include "mesh/certify/certificate.h"
#include "mesh/moving_mesh.h"
#include "mesh/universal_mesh.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

const Box kChannel(Vec3(-6, -6, -14.58), Vec3(6, 6, 14.58));

UmParams with_walls(UmMode mode = UmMode::Fast) {
  UmParams params;
  params.mode = mode;
  params.submesh.background_boundary = BackgroundBoundary::Wall;
  return params;
}

MeshCertificate certificate_of(const BackgroundMesh& background, const UmResult& result, ImplicitFunctionRef psi) {
  const TetMesh mesh{result.final, result.submesh.mesh.C};
  return certify({.mesh = &mesh,
                  .h = background.h(),
                  .positive_faces = &result.submesh.positive_faces,
                  .psi = psi,
                  .wall_faces = &result.walls,
                  .background_V = &result.submesh.mesh.V});
}

/// |x - c| < 1.
struct Ball {
  Vec3 c;
  double value(const Vec3& x) const { return (x - c).squaredNorm() - 1; }
  Vec3 gradient(const Vec3& x) const { return 2 * (x - c); }
  Mat3 hessian(const Vec3&) const { return 2 * Mat3::Identity(); }
};

double area(const TetMesh& mesh, const Triangle& f) {
  return .5 * (mesh.V[f[1]] - mesh.V[f[0]]).cross(mesh.V[f[2]] - mesh.V[f[0]]).norm();
}

TEST(Complement, NegatesTheValueAndBothDerivatives) {
  const auto body = testing::torus();
  const Complement complement(body);
  const ImplicitFunctionRef psi = complement;
  const Vec3 x(.7, -.5, .3);
  Vec3 g;
  Mat3 H;
  EXPECT_EQ(psi.value(x, g, H), -body.value(x));
  EXPECT_EQ(g, -body.gradient(x));
  EXPECT_EQ(H, -body.hessian(x));
  EXPECT_EQ(complement.value(x), -body.value(x));
  EXPECT_EQ(complement.gradient(x), g);
  EXPECT_EQ(complement.hessian(x), H);
}

TEST(Walls, OfTheChannelAreFlatToTheLastBitAndWhole) {
  const BackgroundMesh background(a15_box(kChannel, .8));
  const auto sphere = testing::sphere();
  const UmResult result = universal_mesh(background, Complement(sphere), with_walls());
  ASSERT_EQ(result.status, UmStatus::Success) << result.evidence.what;
  double areas[2][3] = {};
  for (const Triangle& f : result.walls) {
    int n_planes = 0;
    for (int side = 0; side < 2; ++side) {
      for (int a = 0; a < 3; ++a) {
        const double wall = (side ? kChannel.max() : kChannel.min())[a];
        const bool in_plane =
            result.final[f[0]][a] == wall && result.final[f[1]][a] == wall && result.final[f[2]][a] == wall;
        n_planes += in_plane;
        if (in_plane) areas[side][a] += area({result.final, {}}, f);
      }
    }
    EXPECT_EQ(n_planes, 1);
  }
  for (const auto& side : areas) {
    EXPECT_NEAR(side[0], 12 * 29.16, 1e-10);
    EXPECT_NEAR(side[1], 12 * 29.16, 1e-10);
    EXPECT_NEAR(side[2], 144, 1e-10);
  }
}

TEST(Walls, FluidAroundABodyIsCertifiedInBothModesAndOnAnyBackground) {
  const auto body = testing::torus();
  const Complement fluid(body);
  const Box box(body.box.min() - Vec3::Constant(.6), body.box.max() + Vec3::Constant(.6));
  const BackgroundMesh backgrounds[] = {BackgroundMesh(a15_box(box, .15)), BackgroundMesh(a15(), box, .15)};
  for (const BackgroundMesh& background : backgrounds) {
    for (const UmMode mode : {UmMode::Fast, UmMode::Paper}) {
      UmParams params = with_walls(mode);
      params.paper.relaxation_iterations = 6;
      params.fast.layers = 6;  // as far as the walls and beyond
      const UmResult result = universal_mesh(background, fluid, params);
      ASSERT_EQ(result.status, UmStatus::Success) << result.evidence.what;
      const MeshCertificate certificate = certificate_of(background, result, fluid);
      EXPECT_EQ(failures(certificate), std::vector<std::string>{});
      EXPECT_EQ(certificate.boundary.components, 2);
      EXPECT_EQ(certificate.boundary.genus, 1);
      EXPECT_EQ(certificate.boundary.euler_characteristic, 2);
      EXPECT_GT(certificate.n_wall_faces, 0u);
      EXPECT_EQ(certificate.n_wall_faces + certificate.n_positive_faces, certificate.boundary.n_faces);
      EXPECT_LT(*certificate.boundary.max_centroid_distance_over_h, .5);
      std::printf("%s, %s: %zu tets, min Q %.3f, volume %.4f\n", background.is_lattice() ? "lattice" : "box",
                  mode == UmMode::Fast ? "fast" : "paper", certificate.n_tets, certificate.quality.min,
                  certificate.volume);
      EXPECT_GT(certificate.quality.min, .5);
      if (!background.is_lattice()) {
        EXPECT_NEAR(certificate.volume, box.volume() - *body.volume, .04 * *body.volume);
      }
    }
  }
}

TEST(Walls, FluidAroundABodyThatMovesIsUpdated) {
  const Box box(Vec3(-2, -2, -2), Vec3(2.5, 2, 2));
  UniversalMesh fluid(BackgroundMesh(a15_box(box, .2)), with_walls());
  for (const double x : {0., .1, .3}) {
    const Ball ball{Vec3(x, 0, 0)};
    const Complement around(ball);
    const UmUpdate update = fluid.update(around);
    ASSERT_EQ(update.mesh.status, UmStatus::Success) << update.mesh.evidence.what;
    const MeshCertificate certificate = certificate_of(fluid.background(), update.mesh, around);
    EXPECT_EQ(failures(certificate), std::vector<std::string>{});
    EXPECT_EQ(certificate.boundary.components, 2);
    EXPECT_NEAR(certificate.volume, box.volume() - 4. / 3 * std::numbers::pi, .2);
    EXPECT_EQ(update.tets_left.empty(), x == 0);
  }
}

TEST(Walls, BoundaryWithinTwoEdgesOfOneIsRefusedByName) {
  const auto body = testing::sphere();
  const Complement fluid(body);
  const double h = .2;
  for (const UmMode mode : {UmMode::Fast, UmMode::Paper}) {
    UmParams params = with_walls(mode);
    params.paper.relaxation_iterations = 3;
    const auto made = [&](double gap) {
      const Box box(Vec3(-1 - gap, -2, -2), Vec3(2, 2, 2));
      const BackgroundMesh background(a15_box(box, h));
      return universal_mesh(background, fluid, params);
    };
    EXPECT_EQ(made(3.5 * h).status, UmStatus::Success);
    const UmResult near = made(1.5 * h);
    EXPECT_EQ(near.status, UmStatus::BoundaryNearWall);
    EXPECT_GT(near.evidence.count, 0u);
    EXPECT_LT((near.evidence.where + Vec3::UnitX()).norm(), 2.5 * h);
    EXPECT_EQ(made(-.5).status, UmStatus::BoundaryNearWall);
    params.submesh.background_boundary = BackgroundBoundary::Refuse;
    EXPECT_EQ(made(3.5 * h).status, UmStatus::DomainLeavesBackground);
  }
}

TEST(Walls, FluidAroundABodyOfOneEdgeMissesTooMuchOfIt) {
  const auto body = testing::sphere();
  const Complement fluid(body);
  for (const double h : {1., .4}) {
    const BackgroundMesh background(a15_box(Box(Vec3::Constant(-4), Vec3::Constant(4)), h));
    const UmResult made = universal_mesh(background, fluid, with_walls());
    ASSERT_EQ(made.status, UmStatus::Success);
    const MeshCertificate c = certificate_of(background, made, fluid);
    const double in_faces = 512 - c.volume, missed = 4. / 3 * std::numbers::pi / in_faces - 1;
    EXPECT_NEAR(*c.boundary.gap_over_volume, missed, .5 * missed) << h;
    EXPECT_EQ(failures(c).empty(), missed < kMostGap) << h;
    EXPECT_EQ(missed < kMostGap, h < 1) << missed;
  }
}

TEST(Walls, CertificateNoticesAWallThatMovedOrIsMissing) {
  const auto body = testing::sphere();
  const Complement fluid(body);
  const BackgroundMesh background(a15_box(Box(Vec3::Constant(-2), Vec3::Constant(2)), .25));
  const UmResult made = universal_mesh(background, fluid, with_walls());
  ASSERT_EQ(failures(certificate_of(background, made, fluid)), std::vector<std::string>{});

  UmResult moved = made;
  moved.final[moved.walls[0][0]] += Vec3::Constant(1e-9);
  EXPECT_EQ(certificate_of(background, moved, fluid).boundary.n_moved_wall_vertices, 1u);
  EXPECT_EQ(failures(certificate_of(background, moved, fluid)).size(), 1u);

  UmResult missing = made;
  missing.walls.pop_back();
  EXPECT_EQ(certificate_of(background, missing, fluid).boundary.equals_positive_faces, false);

  UmResult wrong = made;
  wrong.walls[0][0] = -1;
  EXPECT_THROW(certificate_of(background, wrong, fluid), std::invalid_argument);
  const TetMesh mesh{made.final, made.submesh.mesh.C};
  EXPECT_THROW(certify({.mesh = &mesh, .psi = {}, .wall_faces = &made.walls}), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
