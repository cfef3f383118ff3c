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

TEST_F(Program, ASegmentationComesOutSmoothAndItsDeviationIsSaid) {
  write_nrrd<unsigned char>(folder / "mask.nrrd", "uchar", 48, is_in_sphere);
  const Result r = run("mesh --level-set mask.nrrd -o mask --h .12");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_NE((r.out + r.err).find("a segmentation of "), std::string::npos) << r.out << r.err;
  EXPECT_NE((r.out + r.err).find("voxels have changed sides, by at most"), std::string::npos) << r.out << r.err;
  const Json c = Json::parse(content(folder / "mask/certificate.json"));
  EXPECT_NEAR(c["volume"].get<double>(), kVolume, .02 * kVolume);
  EXPECT_EQ(run("mesh --level-set mask.nrrd --part 2 -o none --h .12").code, 3);
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

TEST_F(Program, GridsGoWithMeshAlone) {
  write_nrrd<float>(folder / "ball.nrrd", "float", 16, of_sphere);
  EXPECT_EQ(run("mesh --level-set ball.nrrd --implicit x --box=0,0,0,1,1,1 -o a").code, 2);
  EXPECT_EQ(run("run --level-set ball.nrrd -o a").code, 2);
  EXPECT_EQ(run("mesh --level-set ball.nrrd --part 1 -o a").code, 2);
  EXPECT_EQ(run("mesh --level-set none.nrrd -o a").code, 7);
}

}  // namespace
}  // namespace umtet
