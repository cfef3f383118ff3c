#include "mesh/core/tet_quality.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>
#include <string>

#include "mesh/certify/quality_report.h"
#include "mesh/io/quality_csv.h"
#include "tests/support/tet_shapes.h"

namespace umtet {
namespace {

const Vec3 kRegular[4] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};

TEST(DihedralAngles, RegularTetHasArcCosOneThird) {
  const auto range = dihedral_range(kRegular[0], kRegular[1], kRegular[2], kRegular[3]);
  const double expected = std::acos(1.0 / 3) * 180 / std::numbers::pi;
  EXPECT_NEAR(range.min_deg, expected, 1e-13 * 180);
  EXPECT_NEAR(range.max_deg, expected, 1e-13 * 180);
}

TEST(DihedralAngles, CubeCornerHasThreeRightAngles) {
  const Vec3 o(0, 0, 0), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  EXPECT_DOUBLE_EQ(dihedral_angle_deg(o, x, y, z), 90);
  EXPECT_DOUBLE_EQ(dihedral_angle_deg(o, y, z, x), 90);
  EXPECT_DOUBLE_EQ(dihedral_angle_deg(o, z, x, y), 90);
  EXPECT_NEAR(dihedral_range(o, x, y, z).min_deg, std::acos(1 / std::sqrt(3.0)) * 180 / std::numbers::pi, 1e-12);
}

TEST(DihedralAngles, SliverKeepsItsDigits) {
  // At the two diagonals the angle is 180 - 2 atan(e) degrees. A cosine would round to -1 and lose e altogether.
  const double e = 1e-9;
  const double angle = dihedral_angle_deg({-1, 0, 0}, {1, 0, 0}, {0, 1, e}, {0, -1, e});
  EXPECT_NEAR(180 - angle, 2 * e * 180 / std::numbers::pi, 1e-13);  // 180 itself is rounded to 3e-14
}

TEST(DihedralAngles, RangeDoesNotDependOnTheOrderOfVertices) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int trial = 0; trial < 100; ++trial) {
    Vec3 p[4];
    for (Vec3& x : p) x = {u(random), u(random), u(random)};
    std::array<int, 4> order = {0, 1, 2, 3};
    const auto first = dihedral_range(p[0], p[1], p[2], p[3]);
    do {
      const auto range = dihedral_range(p[order[0]], p[order[1]], p[order[2]], p[order[3]]);
      EXPECT_NEAR(range.min_deg, first.min_deg, 1e-9);  // nearly flat random tets lose some of 1e-14
      EXPECT_NEAR(range.max_deg, first.max_deg, 1e-9);
    } while (std::next_permutation(order.begin(), order.end()));
  }
}

TEST(MeanRatio, IsOneForTheRegularTetZeroWhenFlatAndOddInOrientation) {
  EXPECT_NEAR(mean_ratio(kRegular[0], kRegular[1], kRegular[2], kRegular[3]), -1, 1e-15);
  EXPECT_NEAR(mean_ratio(kRegular[1], kRegular[0], kRegular[2], kRegular[3]), 1, 1e-15);
  EXPECT_EQ(mean_ratio({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}), 0);
}

TEST(QualityVector, IsAscendingStartsAtTheWorstTetAndHasOneEntryPerUsedVertex) {
  TetMesh mesh = testing::cubes(3, [](int, int, int) { return true; });
  testing::perturb(mesh, 0.1, 3);
  double least = 1;
  for (const Tet& t : mesh.C) least = std::min(least, mean_ratio(mesh, t));
  mesh.V.emplace_back(9, 9, 9);  // no tet there
  const std::vector<double> Q = mean_ratios(mesh);
  const std::vector<double> q = quality_vectors(mesh.C, Q, {}, mesh.V.size()).all;
  ASSERT_EQ(q.size(), 64u);
  EXPECT_TRUE(std::is_sorted(q.begin(), q.end()));
  EXPECT_NEAR(q[0], least, 1e-14);
  EXPECT_EQ(q[3], q[0]) << "the worst tet has four vertices";
  EXPECT_THROW(quality_vectors(mesh.C, {1.}, {}, mesh.V.size()), std::invalid_argument);
}

TEST(QualityVector, OfTheBoundaryIsThatOfTheTetsWithAPositiveVertex) {
  TetMesh mesh = testing::cubes(3, [](int, int, int) { return true; });
  testing::perturb(mesh, 0.1, 3);
  const auto vectors = [](const TetMesh& m, const std::vector<int>& positive) {
    return quality_vectors(m.C, mean_ratios(m), positive, m.V.size());
  };
  TetMesh part{mesh.V, {}};
  for (const Tet& t : mesh.C) {
    if (std::count(t.begin(), t.end(), 7) + std::count(t.begin(), t.end(), 20) > 0) part.C.push_back(t);
  }
  EXPECT_EQ(vectors(mesh, {7, 20}).boundary, vectors(part, {}).all);
  EXPECT_LT(part.C.size(), mesh.C.size());
  EXPECT_TRUE(vectors(mesh, {}).boundary.empty());
}

TEST(QualityVector, ATetWithoutANumberCountsAsMinusOne) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(mean_ratios({{{nan, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}})[0], -1);
  EXPECT_EQ(mean_ratios({std::vector<Vec3>(4, Vec3(1, 1, 1)), {{0, 1, 2, 3}}})[0], -1);
}

TEST(Quantile, IsLinearBetweenNeighbours) {
  EXPECT_DOUBLE_EQ(quantile({1, 2, 4}, 0.25), 1.5);
  EXPECT_DOUBLE_EQ(quantile({1, 2, 4}, 0.75), 3);
  EXPECT_EQ(quantile({1, 2, 4}, 1), 4);
  EXPECT_EQ(quantile({7}, 0.01), 7);
}

TEST(QualityCsv, HoldsTheWorstHundredAndTheLastOfEachCurveInFewLines) {
  std::vector<double> longer(123456), shorter(777);
  for (std::size_t i = 0; i < longer.size(); ++i) longer[i] = 0.1 + 1e-6 * static_cast<double>(i);
  for (std::size_t i = 0; i < shorter.size(); ++i) shorter[i] = 0.2 + 1e-6 * static_cast<double>(i);
  const auto path = std::filesystem::path(::testing::TempDir()) / "umtet_quality.csv";
  write_quality_csv(path, {{"final", longer}, {"boundary_final", shorter}});
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, "index,final,boundary_final");
  std::size_t n = 0, last_short = 0, last = 0;
  while (std::getline(in, line)) {
    ++n;
    const std::size_t index = std::stoul(line);
    if (n <= 100) {
      EXPECT_EQ(index, n);
    }
    const auto comma = line.find(',');
    EXPECT_EQ(std::stod(line.substr(comma + 1)), longer[index - 1]);
    if (line.back() != ',') {
      last_short = index;
      EXPECT_EQ(std::stod(line.substr(line.rfind(',') + 1)), shorter[index - 1]);
    }
    last = index;
  }
  EXPECT_EQ(last_short, shorter.size());
  EXPECT_EQ(last, longer.size());
  EXPECT_LT(n, 1000u);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace umtet
