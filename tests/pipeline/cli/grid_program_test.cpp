// Level sets and segmentations of other programs, from outside.

#include <cmath>
#include <fstream>
#include <numbers>

#include "common/vec3.h"
#include "tests/pipeline/cli/program_fixture.h"

namespace umtet {
namespace {

/// A NRRD of n^3 nodes in [-1.3, 1.3]^3.
template <class T, class F>
void write_nrrd(const fs::path& file, const char* type, int n, const F& f) {
  std::ofstream out(file, std::ios::binary);
  const double step = 2.6 / (n - 1);
  out << "NRRD0004\ntype: " << type << "\ndimension: 3\nsizes: " << n << ' ' << n << ' ' << n
      << "\nencoding: raw\nendian: little\nspacings: " << step << ' ' << step << ' ' << step
      << "\nspace dimension: 3\nspace origin: (-1.3,-1.3,-1.3)\n\n";
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const T value = static_cast<T>(f(Vec3(-1.3 + i * step, -1.3 + j * step, -1.3 + k * step)));
        out.write(reinterpret_cast<const char*>(&value), sizeof value);
      }
    }
  }
}

double of_sphere(const Vec3& x) { return x.norm() - 1; }
double is_in_sphere(const Vec3& x) { return of_sphere(x) < 0 ? 1 : 0; }

constexpr double kVolume = 4 * std::numbers::pi / 3;

TEST_F(Program, ASphereOnAGridMeshesWithTheErrorThatTheGridAllows) {
  write_nrrd<float>(folder / "ball.nrrd", "float", 64, of_sphere);
  const Result r = run("mesh --level-set ball.nrrd -o ball --h .1 --json");
  ASSERT_EQ(r.code, 0) << r.err;
  const Json c = Json::parse(r.out)["certificate"];
  EXPECT_EQ(c["boundary"]["genus"], 0);
  // Flat faces with edges of h miss .1 % of the volume; the grid nothing that shows beside it.
  const Result exact =
      run("mesh --implicit 'sqrt(x^2+y^2+z^2)-1' --box=-1.3,-1.3,-1.3,1.3,1.3,1.3 -o exact --h .1 --json");
  const double volume = Json::parse(exact.out)["certificate"]["volume"];
  EXPECT_NEAR(c["volume"].get<double>(), volume, 2e-5 * kVolume);
}

/// The block `labels` of a certificate.
Json labels_of(const fs::path& certificate) { return Json::parse(content(certificate))["labels"]; }

TEST_F(Program, ASegmentationKeepsItsVolumeAndItsDeviationIsSaid) {
  write_nrrd<unsigned char>(folder / "mask.nrrd", "uchar", 48, is_in_sphere);
  const Result r = run("mesh --level-set mask.nrrd -o mask --h .12");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_NE((r.out + r.err).find("a segmentation of "), std::string::npos) << r.out << r.err;
  EXPECT_NE((r.out + r.err).find("0 voxels have changed sides"), std::string::npos) << r.out << r.err;
  const Json labels = labels_of(folder / "mask/certificate.json");
  const double of_voxels = labels["volume_of_voxels"];
  EXPECT_NEAR(labels["volume_of_psi"].get<double>(), of_voxels, .002 * of_voxels);
  EXPECT_NEAR(labels["volume_of_mesh"].get<double>(), of_voxels, .02 * of_voxels);
  EXPECT_EQ(labels["pieces_of_mesh"], 1);
  EXPECT_EQ(labels["n_changed_by_more_than_half_a_voxel"], 0);
}

TEST_F(Program, SmallBodiesOfASegmentationAreMeshedWithoutFlags) {
  // Four balls of 3.3 voxels.
  const auto balls = [](const Vec3& x) {
    const Vec3 at(std::abs(x.x()) - .6, std::abs(x.y()) - .6, x.z());
    return at.norm() < .28 ? 1. : 0.;
  };
  write_nrrd<float>(folder / "balls.nrrd", "float", 32, balls);
  const Result r = run("run balls.nrrd -o balls");
  ASSERT_EQ(r.code, 0) << r.err;
  const Json labels = labels_of(folder / "balls/certificate.json");
  const double of_voxels = labels["volume_of_voxels"];
  EXPECT_EQ(labels["pieces_of_mesh"], 4);
  EXPECT_NEAR(labels["volume_of_mesh"].get<double>(), of_voxels, .03 * of_voxels);
}

TEST_F(Program, AKernelIsUsedWhereItIsAskedFor) {
  write_nrrd<unsigned char>(folder / "mask.nrrd", "uchar", 48, is_in_sphere);
  const Result r = run("mesh --level-set mask.nrrd --part-smooth 1 -o mask --h .12");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_NE((r.out + r.err).find("smoothed over 1 voxels (--part-smooth)"), std::string::npos) << r.out << r.err;
  EXPECT_EQ(labels_of(folder / "mask/certificate.json")["kernel"], 1);
}

TEST_F(Program, AMissingPartIsRefusedWithThePartsThatExist) {
  write_nrrd<unsigned char>(folder / "mask.nrrd", "uchar", 16,
                            [](const Vec3& x) { return x.norm() < 1 ? (x.z() > 0 ? 7 : 3) : 0; });
  const Result r = run("mesh --level-set mask.nrrd --part 2 -o none --h .12");
  EXPECT_EQ(r.code, 3);
  EXPECT_NE(r.err.find("the parts are 3 ("), std::string::npos) << r.err;
  EXPECT_NE(r.err.find(", 7 ("), std::string::npos) << r.err;
  const Result seen = run("inspect mask.nrrd");
  EXPECT_EQ(seen.code, 0) << seen.err;
  EXPECT_NE(seen.out.find("part 3 "), std::string::npos) << seen.out;
  EXPECT_NE(seen.out.find("part 7 "), std::string::npos) << seen.out;
}

/// Bright in a ball of .7, dark around it.
double of_scanner(const Vec3& x) { return std::round(1000 / (1 + std::exp(15 * (x.norm() - .7)))); }

TEST_F(Program, AnImageOfGreyValuesAsksForALevel) {
  write_nrrd<short>(folder / "ct.nrrd", "short", 32, of_scanner);
  const Result r = run("run ct.nrrd -o ct");
  EXPECT_EQ(r.code, 3);
  EXPECT_NE(r.err.find("--level"), std::string::npos) << r.err;
  EXPECT_FALSE(fs::exists(folder / "ct/3-mesh/mesh.vtu"));
  const Result seen = run("inspect ct.nrrd");
  EXPECT_EQ(seen.code, 0) << seen.err;
  EXPECT_NE(seen.out.find("such as --level "), std::string::npos) << seen.out;
}

TEST_F(Program, TheSideOfALevelIsTheOneThatDoesNotReachTheWall) {
  write_nrrd<short>(folder / "ct.nrrd", "short", 32, of_scanner);
  for (const std::string level : {"500", "500:", "500 --above"}) {
    const Result r = run("run ct.nrrd -o ct --force --h .15 --json --level " + level);
    ASSERT_EQ(r.code, 0) << level << r.err;
    EXPECT_NEAR(Json::parse(r.out)["certificate"]["volume"].get<double>(), kVolume * .343, .05) << level;
  }
  const Result below = run("run ct.nrrd -o below --h .2 --json --level :500");
  EXPECT_NE(below.err.find("give --above"), std::string::npos) << below.err;
  EXPECT_EQ(run("run ct.nrrd -o ct --level 5:3").code, 2);
  EXPECT_EQ(run("run ct.nrrd -o ct --level :500 --above").code, 2);
}

TEST_F(Program, AGridThatHasChangedIsMeshedAgain) {
  write_nrrd<float>(folder / "ball.nrrd", "float", 24, of_sphere);
  ASSERT_EQ(run("mesh --level-set ball.nrrd -o ball --h .3").code, 0);
  const std::string before = content(folder / "ball/3-mesh/mesh.vtu");
  const auto time = fs::last_write_time(folder / "ball/3-mesh/mesh.vtu");
  ASSERT_EQ(run("mesh ball").code, 0);
  EXPECT_EQ(fs::last_write_time(folder / "ball/3-mesh/mesh.vtu"), time);
  write_nrrd<float>(folder / "ball.nrrd", "float", 24, [](const Vec3& x) { return x.norm() - .8; });
  ASSERT_EQ(run("mesh ball").code, 0);
  EXPECT_NE(content(folder / "ball/3-mesh/mesh.vtu"), before);
}

TEST_F(Program, ALevelOfAFieldIsASurfaceOfIt) {
  write_nrrd<float>(folder / "r.nrrd", "float", 32, [](const Vec3& x) { return x.norm(); });
  const Result r = run("mesh --level-set r.nrrd --level .7 -o r --h .15 --json");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_NEAR(Json::parse(r.out)["certificate"]["volume"].get<double>(), kVolume * .343, .02);
}

TEST_F(Program, WhatIsSaidOfAGridNeedsOne) {
  write_nrrd<float>(folder / "ball.nrrd", "float", 16, of_sphere);
  EXPECT_EQ(run("mesh --level-set ball.nrrd --implicit x --box=0,0,0,1,1,1 -o a").code, 2);
  EXPECT_EQ(run("run --level-set ball.nrrd -o a").code, 2);
  EXPECT_EQ(run("mesh --level-set ball.nrrd --part 1 -o a").code, 2);
  EXPECT_EQ(run("mesh --implicit x --part 1 --box=0,0,0,1,1,1 -o a").code, 2);
  EXPECT_EQ(run("mesh --level-set none.nrrd -o a").code, 7);
}

}  // namespace
}  // namespace umtet
