// Clouds of real shapes, from file to certificate by the program itself.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "mesh/certify/boundary_surface.h"
#include "mesh/io/tet_mesh_io.h"
#include "reconstruct/io/level_set_io.h"
#include "reconstruct/io/point_cloud_io.h"
#include "tests/support/data_files.h"
#include "tests/support/sampled_domains.h"

namespace fs = std::filesystem;
using umtet::test::committed_cloud;
using umtet::test::real_cloud;

namespace {

struct Scan {
  std::string name;
  int genus;
};

fs::path own_folder() { return fs::temp_directory_path() / ("umtet_scan_" + std::to_string(::getpid())); }

/// Runs `umtet run CLOUD` without a flag and holds the certificate against what is known of the shape.
/// @param look  at the case, while it is there
void expect_certified(const fs::path& cloud, int genus, const std::function<void(const fs::path&)>& look = {}) {
  const fs::path folder = own_folder();
  fs::create_directories(folder);
  const std::string call = std::string("'") + UMTET_PROGRAM + "' run '" + cloud.string() + "' -o '" +
                           (folder / "case").string() + "' --json -q >'" + (folder / "out").string() + "'";
  const int status = std::system(call.c_str());
  std::ifstream out(folder / "out");
  const nlohmann::json document = nlohmann::json::parse(out, nullptr, /*allow_exceptions=*/false);
  ASSERT_TRUE(WIFEXITED(status) && !document.is_discarded());
  EXPECT_EQ(WEXITSTATUS(status), 0) << document.dump(1);
  if (WEXITSTATUS(status) == 0) {
    const nlohmann::json& c = document["certificate"];
    std::printf("  %-26s %7ld tets   min Q %.3f   genus %ld\n", cloud.filename().c_str(), c["n_tets"].get<long>(),
                c["quality"]["min"].get<double>(), c["boundary"]["genus"].get<long>());
    // Outliers that cleaning leaves are a named defect.
    EXPECT_EQ(c["verdict"].get<std::string>().find("pass"), 0u) << c["verdict"];
    EXPECT_EQ(c["boundary"]["genus"], genus);
    EXPECT_EQ(c["boundary"]["components"], 1);
    EXPECT_EQ(c["quality"]["n_inverted"], 0);
    EXPECT_GE(c["quality"]["min"].get<double>(), .70);
    EXPECT_LE(c["cloud"]["p99_distance_over_h"].get<double>(), 1.0);
    if (look) look(folder / "case");
  }
  fs::remove_all(folder);
}

}  // namespace

TEST(Scans, CommittedCloudsAreCertified) {
  for (const Scan& s : {Scan{"duck.ply", 1}, Scan{"bird.ply", 0}, Scan{"knot.ply", 7}, Scan{"torus_hole_noise.ply", 1},
                        Scan{"blob_nonuniform.ply", 0}}) {
    SCOPED_TRACE(s.name);
    expect_certified(committed_cloud(s.name), s.genus);
  }
}

TEST(Scans, RealCloudsAreCertified) {
  for (const Scan& s : {Scan{"duck.ply", 1}, Scan{"spot_ascii.ply", 0}, Scan{"blub.xyz", 0}, Scan{"koala.ply", 0},
                        Scan{"spot_large.ply", 0}}) {
    SCOPED_TRACE(s.name);
    const std::optional<fs::path> cloud = real_cloud(s.name);
    if (!cloud) GTEST_SKIP() << "needs " << s.name << " in the folder of real scans";
    expect_certified(*cloud, s.genus);
  }
}

// How far a mesh is from its samples is, of a noisy cloud, what the samples are off; the surface they are samples of is
// known here: the torus R = 1, r = .4, with noise of .0081 (data/README.md).
TEST(Scans, NoisyTorusIsNearTheTrueOne) {
  using namespace umtet;
  expect_certified(committed_cloud("torus_hole_noise.ply"), 1, [](const fs::path& made) {
    std::ifstream in(made / "certificate.json");
    const nlohmann::json c = nlohmann::json::parse(in);
    const double h = c["h"], noise = c["cloud"]["noise"];
    EXPECT_NEAR(noise, .0081, .0004);
    EXPECT_DOUBLE_EQ(c["cloud"]["noise_over_h"], noise / h);
    EXPECT_LE(c["cloud"]["rms_distance"], 1.05 * noise);
    const MeshFile file = read_tet_mesh(made / "3-mesh" / "mesh.vtu");
    const std::vector<Vec3>& V = file.mesh.V;
    std::vector<double> off;
    double sum2 = 0;
    for (const Triangle& f : boundary_faces(file.mesh.C, V.size()).triangles) {
      const Vec3 x = (V[f[0]] + V[f[1]] + V[f[2]]) / 3;
      off.push_back(std::abs(std::hypot(std::hypot(x[0], x[1]) - 1, x[2]) - .4) / h);
      sum2 += off.back() * off.back();
    }
    std::sort(off.begin(), off.end());
    const double rms = std::sqrt(sum2 / static_cast<double>(off.size())), p99 = off[off.size() * 99 / 100];
    std::printf("  face centres to the true torus: rms %.3f h, 99 %% %.3f h\n", rms, p99);
    EXPECT_LE(rms, .06);
    EXPECT_LE(p99, .18);
  });
}

// The worst scan that is asked for: 50,000 samples of eq. (9) with noise of .5 % of the diagonal along each axis and 6
// degrees on the normals, and the same with 1 % of outliers.
TEST(Scans, NoisyEquation9KeepsItsShape) {
  using namespace umtet;
  const OrientedPointCloud clean = test::sampled(umtet::testing::equation_9(), 50000, 5);
  const std::vector<Vec3> truth = test::sampled(umtet::testing::equation_9(), 20000, 99).points;
  const double diagonal = test::box_diagonal(clean.points);
  const OrientedPointCloud noisy = test::with_tilted_normals(test::with_noise(clean, .005 * diagonal), 6);
  for (const int n_outliers : {0, 500}) {
    SCOPED_TRACE(std::to_string(n_outliers) + " outliers");
    fs::create_directories(own_folder());
    const fs::path file = own_folder() / "equation_9.ply";
    std::ofstream out(file, std::ios::binary);
    write_ply(out, test::with_outliers(noisy, n_outliers));
    out.close();
    expect_certified(file, 2, [&](const fs::path& made) {
      const LevelSet psi = read_level_set(made / "2-level-set" / "level_set.vti");
      const double mean = test::mean_and_max_distance(psi, truth).first / diagonal;
      std::printf("  mean distance %.3g of the diagonal\n", mean);
      EXPECT_LE(mean, 3.5e-4);
    });
  }
}
