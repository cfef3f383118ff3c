#include "mesh/certify/detail/tet_measures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "mesh/certify/quality_report.h"
#include "mesh/core/orientation.h"
#include "mesh/core/tet_packs.h"
#include "mesh/core/tet_quality.h"

namespace umtet {
namespace {

double cotangent2(double degrees) {
  const double cotangent = 1 / std::tan(degrees * M_PI / 180);
  return cotangent * std::abs(cotangent);
}

/// Vertices 4 t .. 4 t + 3 for tet t: random ones, some flattened, and some of other sizes.
TetMesh random_tets(std::size_t n) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  TetMesh mesh;
  for (std::size_t t = 0; t < n; ++t) {
    const double size = t % 7 == 0 ? 1e-40 : t % 7 == 1 ? 1e40 : 1, thickness = t % 5 == 0 ? 1e-13 : 1;
    for (int k = 0; k < 4; ++k) {
      mesh.V.push_back(size * Vec3(uniform(random), uniform(random), k == 3 ? thickness * uniform(random) : 0));
    }
    const int v = static_cast<int>(4 * t);
    mesh.C.push_back({v, v + 1, v + 2, v + 3});
  }
  return mesh;
}

TEST(TetPack, AgreeWithWhatIsMeasuredOfOneTet) {
  const TetMesh mesh = random_tets(2000);
  std::size_t n_inverted = 0;
  for (std::size_t t = 0; t + 4 <= mesh.C.size(); t += 4) {
    const TetPack lanes = measure_tet_pack(mesh, &mesh.C[t], 4);
    for (int m = 0; m < 4; ++m) {
      const Tet& tet = mesh.C[t + m];
      const Vec3 &a = mesh.V[tet[0]], &b = mesh.V[tet[1]], &c = mesh.V[tet[2]], &d = mesh.V[tet[3]];
      const double Q = mean_ratio(a, b, c, d), rms = std::sqrt(sum_of_squared_edges(a, b, c, d) / 6);
      EXPECT_NEAR(lanes.quality[m], Q, 1e-14 + 1e-13 * std::abs(Q)) << t + m;
      EXPECT_NEAR(lanes.volume6[m], volume6(a, b, c, d), 1e-14 * rms * rms * rms);
      EXPECT_NEAR(lanes.rms_edge[m], rms, 1e-15 * rms);
      EXPECT_EQ(lanes.inverted[m], orientation_sign(a, b, c, d) <= 0);
      n_inverted += lanes.inverted[m];
      if (std::abs(Q) < .01) continue;  // angles of 0 and 180 degrees: tangents are rounding
      const DihedralRange angles = dihedral_range(a, b, c, d);
      const double least = cotangent2(angles.max_deg), greatest = cotangent2(angles.min_deg);
      EXPECT_NEAR(lanes.least_cotangent[m], least, 1e-9 * (1 + std::abs(least))) << t + m;
      EXPECT_NEAR(lanes.greatest_cotangent[m], greatest, 1e-9 * (1 + std::abs(greatest))) << t + m;
    }
  }
  EXPECT_GT(n_inverted, 500u);
  EXPECT_LT(n_inverted, 1500u);
}

TEST(TetPack, ATetWithTwoCornersAtOnePlaceHasAnAngleOfZero) {
  for (int k = 1; k < 4; ++k) {
    TetMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}};
    mesh.V[k] = mesh.V[0];
    const TetPack lanes = measure_tet_pack(mesh, &mesh.C[0], 1);
    EXPECT_EQ(lanes.greatest_cotangent[0], std::numeric_limits<double>::infinity()) << k;
    EXPECT_EQ(std::signbit(lanes.quality[0]), false) << k;
    EXPECT_TRUE(lanes.inverted[0]) << k;
  }
}

TEST(TetPack, WhatIsFoundOfATetDoesNotDependOnTheOthers) {
  TetMesh mesh = random_tets(7);
  mesh.V[9] = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());  // of tet 2
  mesh.V[20] = mesh.V[21] = mesh.V[22] = mesh.V[23];                     // tet 5 in one point
  const TetPack first = measure_tet_pack(mesh, &mesh.C[0], 4), later = measure_tet_pack(mesh, &mesh.C[3], 4);
  EXPECT_EQ(first.quality[3], later.quality[0]);
  EXPECT_EQ(first.volume6[3], later.volume6[0]);
  EXPECT_EQ(first.least_cotangent[3], later.least_cotangent[0]);
  EXPECT_EQ(measure_tet_pack(mesh, &mesh.C[3], 1).quality[0], later.quality[0]);
  EXPECT_EQ(first.quality[2], -1) << "not a number";
  EXPECT_TRUE(first.inverted[2]);
  EXPECT_EQ(later.quality[2], -1) << "no size";
  EXPECT_TRUE(later.inverted[2]);
}

TEST(TetMeasures, QuantilesAreThoseOfAllTetsWhereverThePoorOnesAre) {
  // Flatter and flatter copies of one tet. Poor ones are evenly spread, or nearly all in the blocks that are looked at
  // first (1024 tets, every sixth of them), which then promise too much.
  constexpr std::size_t kBlock = 1024, kBlocks = 384, kShapes = 5000;
  TetMesh mesh;
  mesh.V = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (std::size_t k = 0; k < kShapes; ++k) mesh.V.emplace_back(0, 0, 1 - static_cast<double>(k) / (kShapes + 1));
  std::mt19937 random(5);
  std::uniform_int_distribution<int> good(0, kShapes / 2), any(0, kShapes - 1);
  for (const bool even : {true, false}) {
    mesh.C.clear();
    for (std::size_t t = 0; t < kBlock * kBlocks - 3; ++t) {
      const bool may_be_poor = even || ((t / kBlock) % 6 == 0 && t % 8 == 0);
      mesh.C.push_back({0, 1, 2, 3 + (may_be_poor ? any(random) : good(random))});
    }
    std::vector<double> Q;
    for (const Tet& t : mesh.C) Q.push_back(mean_ratio(mesh, t));
    std::sort(Q.begin(), Q.end());
    MeshCertificate certificate;
    detail::measure_tets(mesh, 0, {}, nullptr, certificate);
    EXPECT_NEAR(certificate.quality.min, Q.front(), 1e-14);
    EXPECT_NEAR(certificate.quality.p001, quantile(Q, .001), 1e-14);
    EXPECT_NEAR(certificate.quality.p01, quantile(Q, .01), 1e-14);
  }
}

}  // namespace
}  // namespace umtet
