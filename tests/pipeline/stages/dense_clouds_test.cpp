// Clouds much denser than their mesh can show: their samples become one a cell before anything is made of them.

#include <cmath>
#include <numbers>
#include <random>
#include <sstream>

#include "reconstruct/io/point_cloud_io.h"
#include "tests/pipeline/cli/program_fixture.h"

namespace umtet {
namespace {

constexpr int kDense = 450'000;  // four samples for each of 100,000 cells and some more

Json record(const fs::path& stage) { return Json::parse(content(stage / "record.json")); }

class DenseClouds : public Program {
 protected:
  void write(const std::string& name, const OrientedPointCloud& cloud) const {
    std::ofstream out(folder / name, std::ios::binary);
    write_ply(out, cloud);
  }
  /// On a spiral around the ellipsoid 1 : .8 : .6, with noise along the normals.
  static OrientedPointCloud egg(int n, double noise = 0) {
    std::mt19937_64 random(1);
    std::normal_distribution<double> gauss;
    OrientedPointCloud cloud;
    for (int i = 0; i < n; ++i) {
      const double z = 1 - (2 * i + 1.) / n, r = std::sqrt(1 - z * z), a = 2.399963229728653 * i;
      const Vec3 u(r * std::cos(a), r * std::sin(a), z), normal = Vec3(u[0], u[1] / .8, u[2] / .6).normalized();
      cloud.points.emplace_back(Vec3(u[0], .8 * u[1], .6 * u[2]) + noise * gauss(random) * normal);
      cloud.normals.push_back(normal);
    }
    return cloud;
  }
  Json certificate(const std::string& name) const { return Json::parse(content(folder / name / "certificate.json")); }
};

TEST_F(DenseClouds, MakeTheMeshOfAllTheirSamplesFromFewer) {
  OrientedPointCloud dense = egg(kDense);
  for (const Vec3& x : dense.points) dense.labels.push_back(x[2] > 0 ? 1 : 2);
  dense.fields = {{"height", {}}};
  for (const Vec3& x : dense.points) dense.fields[0].values.push_back(x[2]);
  write("dense.ply", dense);
  const Result r = run("run dense.ply -o few --tets 300000 --no-report");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_NE(r.err.find("merged 450000 points"), std::string::npos) << r.err;
  ASSERT_EQ(run("run dense.ply -o all --tets 300000 --no-report --set cloud.merge=false").code, 0);
  const Json merged = record(folder / "few/1-cloud")["numbers"]["merged"];
  EXPECT_EQ(merged["n_points"], kDense);
  EXPECT_LT(merged["n_samples"], kDense / 3);
  EXPECT_FALSE(record(folder / "all/1-cloud")["numbers"].contains("merged"));

  const Json few = certificate("few"), all = certificate("all");
  EXPECT_EQ(few["cloud"]["n_merged"], kDense);
  EXPECT_EQ(few["n_points"], merged["n_samples"]);
  EXPECT_NEAR(few["h"].get<double>() / all["h"].get<double>(), 1, .01);
  EXPECT_NEAR(few["volume"].get<double>() / all["volume"].get<double>(), 1, 1e-4);
  EXPECT_LT(few["cloud"]["rms_distance"], 1.05 * all["cloud"]["rms_distance"].get<double>());
  EXPECT_LT(few["cloud"]["p99_distance"], 1.1 * all["cloud"]["p99_distance"].get<double>());
  EXPECT_GT(few["quality"]["min"], all["quality"]["min"].get<double>() - .02);

  // No lattice is fitted that the mesh does not use, and the finest that it may use is.
  const Json fit = record(folder / "few/2-level-set")["numbers"];
  const double h = few["h"];
  EXPECT_GT(fit["spacing"], .7 * h);
  EXPECT_LT(fit["spacing"], .8 * h);
  EXPECT_LT(record(folder / "all/2-level-set")["numbers"]["spacing"], .3 * h);

  const CloudFile kept = read_point_cloud(folder / "few/1-cloud/cloud.ply");
  ASSERT_EQ(kept.cloud.counts.size(), kept.cloud.points.size());
  for (std::size_t i = 0; i < kept.cloud.points.size(); ++i) {
    EXPECT_EQ(kept.cloud.labels[i], kept.cloud.fields[0].values[i] > 0 ? 1 : 2);
    EXPECT_NEAR(kept.cloud.fields[0].values[i], kept.cloud.points[i][2], 1e-3);
  }
}

TEST_F(DenseClouds, AreMergedAgainForAFinerMesh) {
  write("dense.ply", egg(kDense));
  ASSERT_EQ(run("run dense.ply -o case --h .12 --no-report").code, 0);
  const double cell = record(folder / "case/1-cloud")["numbers"]["merged"]["cell"];
  EXPECT_EQ(run("run dense.ply -o case --h .12 --no-report").err.find("cloud: done"), std::string::npos);
  const Result finer = run("run dense.ply -o case --h .035 --no-report");
  ASSERT_EQ(finer.code, 0) << finer.err;
  EXPECT_NE(finer.err.find("made for a mesh of another resolution"), std::string::npos) << finer.err;
  const Json numbers = record(folder / "case/1-cloud")["numbers"];
  EXPECT_LE(numbers.value("/merged/cell"_json_pointer, 0.), cell);
  EXPECT_LT(record(folder / "case/2-level-set")["numbers"]["spacing"], .8 * .035);
}

TEST_F(DenseClouds, ShowTheirNoise) {
  constexpr double kNoise = .004;
  constexpr int kMany = 700'000;
  write("noisy.ply", egg(kMany, kNoise));
  ASSERT_EQ(run("run noisy.ply -o noisy --tets 20000 --no-report").code, 0);
  const Json cloud = certificate("noisy")["cloud"];
  ASSERT_TRUE(cloud.contains("n_merged"));
  EXPECT_GT(cloud["n_merged"], .999 * kMany) << "tails of noise are no outliers";
  EXPECT_NEAR(cloud["noise"], kNoise, .15 * kNoise);
  EXPECT_NEAR(cloud["rms_distance"], kNoise, .15 * kNoise) << "of the samples as they came, not of their means";
}

TEST_F(DenseClouds, OfThinBodiesAreLeftAsTheyAre) {
  // A plate a hundredth as thick as it is wide, with and without normals.
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  OrientedPointCloud plate;
  for (int i = 0; i < kDense; ++i) {
    plate.points.emplace_back(unit(random), unit(random), i % 2 * .005);
    plate.normals.emplace_back(0, 0, i % 2 == 0 ? -1 : 1);
  }
  write("plate.ply", plate);
  const Result r = run("reconstruct plate.ply -o plate");
  EXPECT_EQ(r.err.find("merged"), std::string::npos) << r.err;
}

TEST_F(DenseClouds, KeepTheirSamplesWhereSheetsAreNearEachOther) {
  // A plate above the egg, with a twentieth of all samples.
  constexpr double kHeight = .9, kThickness = .008;
  constexpr int kPlate = 60'000;
  OrientedPointCloud dense = egg(1'000'000);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < kPlate; ++i) {
    const bool up = i % 2 == 0;
    dense.points.emplace_back(.5 * unit(random), .5 * unit(random), up ? kHeight + kThickness : kHeight);
    dense.normals.emplace_back(0, 0, up ? 1 : -1);
  }
  write("plate_and_egg.ply", dense);
  const Result r = run("run plate_and_egg.ply -o case --h .04 --no-report");
  EXPECT_EQ(r.code, 6) << "h does not show the plate. " << r.err;
  EXPECT_NE(r.err.find("merged 1060000 points"), std::string::npos) << r.err;
  const OrientedPointCloud kept = read_point_cloud(folder / "case/1-cloud/cloud.ply").cloud;
  std::size_t n_plate = 0;
  for (std::size_t i = 0; i < kept.points.size(); ++i) {
    if (kept.points[i][2] < .5 * (.6 + kHeight)) continue;
    ++n_plate;
    ASSERT_EQ(kept.counts[i], 1) << "at " << kept.points[i].transpose();
  }
  EXPECT_GT(n_plate, .99 * kPlate);
  EXPECT_LT(kept.points.size() - n_plate, 300'000u) << "the egg is merged";
}

TEST_F(DenseClouds, ThatAreHardlyDenserAreLeftAsTheyAre) {
  write("sparse.ply", egg(kDense / 2));
  const Result r = run("reconstruct sparse.ply -o sparse");  // less than two in a cell of .0026 diagonals
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(r.err.find("merged"), std::string::npos) << r.err;
}

}  // namespace
}  // namespace umtet
