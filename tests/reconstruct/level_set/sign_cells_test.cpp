// The list of cubes where a level set can be zero.

#include "reconstruct/level_set/sign_cells.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "reconstruct/solve/fit_ssd.h"
#include "tests/support/clouds.h"

using namespace umtet;
using namespace umtet::test;

namespace {

using Cube = std::array<int, 3>;

std::set<Cube> as_set(const SignCells& s) {
  std::set<Cube> cubes;
  for (const Eigen::Vector3i& c : s.cells) cubes.insert({c[0], c[1], c[2]});
  return cubes;
}

Cube cube_of(const SignCells& s, const Vec3& x) {
  const Eigen::Vector3i c = ((x - s.origin) / s.size).array().floor().cast<int>();
  return {c[0], c[1], c[2]};
}

LevelSet torus(double spacing) {
  SsdParams p;
  p.spacing = spacing;
  p.coarsest_nodes = 20000;
  return fit_ssd(torus_cloud(6000), p).psi;
}

}  // namespace

TEST(SignCells, HoldEveryZeroAndFewOthers) {
  const LevelSet psi = torus(0.05);
  ASSERT_GE(psi.n_levels(), 2);
  for (const double size : {psi.lattice(0).h, psi.spacing(), psi.spacing() / 2}) {
    const SignCells cells = sign_cells(psi, size);
    const std::set<Cube> listed = as_set(cells);
    std::set<Cube> crossed;
    for (Vec3 x : torus_cloud(40000, 4).points) {
      for (int it = 0; it < 5; ++it) {
        Vec3 g;
        const double f = psi.evaluate(x, &g, nullptr);
        x -= f / g.squaredNorm() * g;
      }
      crossed.insert(cube_of(cells, x));
    }
    for (const Cube& c : crossed) ASSERT_TRUE(listed.contains(c)) << size;
    // The bound closes in with the square of the edge.
    if (size < psi.lattice(0).h) {
      EXPECT_LT(listed.size(), 5 * crossed.size()) << size;
    }
  }
}

TEST(SignCells, WithinSomeCubesAreThoseOfTheWholeSearch) {
  const LevelSet psi = torus(0.1);
  const SignCells coarse = sign_cells(psi, psi.spacing() / 2), all = sign_cells(psi, psi.spacing() / 8);
  std::vector<int> odd;
  std::set<Cube> parents;
  for (int c = 1; c < static_cast<int>(coarse.cells.size()); c += 2) {
    odd.push_back(c);
    parents.insert({coarse.cells[c][0], coarse.cells[c][1], coarse.cells[c][2]});
  }
  const SignCells within = sign_cells_within(psi, coarse, odd, psi.spacing() / 8);
  std::vector<Eigen::Vector3i> expected;
  for (const Eigen::Vector3i& c : all.cells) {
    if (parents.contains({c[0] >> 2, c[1] >> 2, c[2] >> 2})) expected.push_back(c);
  }
  EXPECT_FALSE(expected.empty());
  EXPECT_LT(expected.size(), all.cells.size());
  EXPECT_EQ(within.size, all.size);
  EXPECT_EQ(within.cells, expected);
  EXPECT_THROW(sign_cells_within(psi, all, odd, coarse.size), std::invalid_argument);
}

TEST(SignCells, SignsOutsideAreConstant) {
  // Between two points of an unlisted cube psi has one sign, and it is zero at neither.
  const LevelSet psi = torus(0.1);
  const SignCells cells = sign_cells(psi, psi.spacing());
  const std::set<Cube> listed = as_set(cells);
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  int unlisted = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const Vec3 x =
        psi.domain().min() + Vec3(unit(random), unit(random), unit(random)).cwiseProduct(psi.domain().sizes());
    const Cube c = cube_of(cells, x);
    if (listed.contains(c)) continue;
    const Vec3 y = cells.origin + cells.size * Vec3(c[0] + unit(random), c[1] + unit(random), c[2] + unit(random));
    EXPECT_GT(psi.value(x) * psi.value(y), 0);
    ++unlisted;
  }
  EXPECT_GT(unlisted, 10000);
}

TEST(SignCells, FindABallBetweenTheNodesOfAFinerLattice) {
  // One coefficient of a band makes a zero set that none of the coarse nodes shows.
  const Lattice coarse{{0, 0, 0}, 1, {21, 21, 21}}, fine{{0, 0, 0}, 0.5, {41, 41, 41}};
  LevelSetBand band{LatticeBlocks(fine, 3, {{2, 2, 2}}), std::vector<float>(LatticeBlocks::kNodes, 0.f)};
  const Eigen::Vector3i node = band.blocks.first_node(0) + Eigen::Vector3i(3, 4, 5);
  band.coefficients[3 + 8 * (4 + 8 * 5)] = -7;
  const LevelSet psi(LmePrior{}, {coarse, std::vector<double>(coarse.size(), 1.0)}, {band});
  const Vec3 middle = 0.5 * node.cast<double>();
  ASSERT_LT(psi.value(middle), 0);
  const SignCells cells = sign_cells(psi, 1. / 16);
  ASSERT_FALSE(cells.cells.empty());
  for (const Eigen::Vector3i& c : cells.cells) {
    EXPECT_LT((cells.origin + cells.size * (c.cast<double>() + Vec3::Constant(0.5)) - middle).norm(), 1.5);
  }
  EXPECT_TRUE(
      sign_cells(LevelSet(LmePrior{}, {coarse, std::vector<double>(coarse.size(), 1.0)}), 1. / 16).cells.empty());
}

TEST(SignCells, RefusesSizesThatCannotBeMade) {
  const LevelSet psi = torus(0.2);
  EXPECT_THROW(sign_cells(psi, 0), std::invalid_argument);
  EXPECT_THROW(sign_cells(psi, 1e-9), std::invalid_argument);
}
