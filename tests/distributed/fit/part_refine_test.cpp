// Steps of the multilevel fit by all ranks, against one process.

#include "distributed/fit/part_refine.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstring>
#include <optional>

#include "distributed/fit/band_cut.h"
#include "reconstruct/solve/fit_ssd.h"
#include "reconstruct/solve/ssd_band.h"
#include "tests/distributed/ranks.h"
#include "tests/support/clouds.h"

namespace umtet {
namespace {

using testing::n_ranks;
using testing::rank;

/// A level set, on all ranks.
LevelSet coarse_torus() {
  SsdParams params;
  params.spacing = .16;
  return fit_ssd(test::torus_cloud(3000), params).psi;
}

/// Of half the spacing of its last level.
Lattice finer_lattice(const LevelSet& psi) {
  const Lattice& coarse = psi.lattice(psi.n_levels() - 1);
  return {coarse.origin, coarse.h / 2, (2 * (coarse.n.array() - 1) + 1).matrix()};
}

/// Of that lattice; on rank 0.
std::vector<SsdSample> finer_samples(const LevelSet& psi, int n, double least_x = -2) {
  const Lattice fine = finer_lattice(psi);
  const OrientedPointCloud cloud = test::torus_cloud(n, 5);
  std::vector<SsdSample> samples;
  for (std::size_t i = 0; i < cloud.points.size() && rank() == 0; ++i) {
    if (cloud.points[i].x() < least_x) continue;
    SsdSample& s = samples.emplace_back();
    s.xi = (cloud.points[i] - fine.origin) / fine.h;
    s.normal = cloud.normals[i];
    s.w_value = 2.5, s.w_gradient = .7, s.gap2 = .7;
  }
  return merge_samples(samples, .5);
}

/// Of that lattice.
BandPart part_of(const LevelSet& psi, const std::vector<SsdSample>& samples) {
  return band_part(MPI_COMM_WORLD, rank() == 0 ? finer_lattice(psi) : Lattice{},
                   rank() == 0 ? psi.tables().half_width() : 0, samples);
}

bool are_equal(const LevelSet& a, const LevelSet& b) {
  bool equal = a.n_levels() == b.n_levels();
  for (int level = 1; equal && level < a.n_levels(); ++level) {
    const std::vector<float>&x = a.band(level).coefficients, &y = b.band(level).coefficients;
    equal = a.band(level).blocks == b.band(level).blocks && x.size() == y.size() &&
            std::memcmp(x.data(), y.data(), x.size() * sizeof(float)) == 0;
  }
  return equal;
}

/// Two steps, of all ranks and of one.
void expect_same(const LevelSet& psi, int n, double least_x = -2) {
  const RefineParams params{.01, 1e-3, 100};
  LevelSet all = psi, one = psi;
  for (int step = 0; step < 2; ++step) {
    const std::vector<SsdSample> samples = finer_samples(all, n, least_x);
    BandReport of_all, of_one;
    int n_calls = 0;
    all = refine_parts(
        MPI_COMM_WORLD, all, part_of(all, samples), params, [&](double) { ++n_calls; }, of_all);
    EXPECT_EQ(n_calls, of_all.iterations);
    if (rank() != 0) continue;
    one = refine(
        one, samples, params.kappa, params.tolerance, params.max_iterations, [](double) {}, of_one);
    EXPECT_TRUE(are_equal(all, one)) << "step " << step;
    EXPECT_GT(of_one.iterations, 3);
    EXPECT_EQ(of_all.iterations, of_one.iterations);
    EXPECT_EQ(of_all.residual, of_one.residual);
    EXPECT_EQ(of_all.n_nodes, of_one.n_nodes);
    EXPECT_EQ(of_all.n_samples, of_one.n_samples);
    EXPECT_EQ(of_all.converged, of_one.converged);
    EXPECT_EQ(of_all.spacing, of_one.spacing);
  }
  // All ranks have the same.
  std::vector<float> others = all.band(2).coefficients;
  MPI_Bcast(others.data(), static_cast<int>(others.size()), MPI_FLOAT, 0, MPI_COMM_WORLD);
  EXPECT_EQ(others, all.band(2).coefficients);
}

TEST(PartRefine, IsThatOfOneProcessToTheBit) { expect_same(coarse_torus(), 20000); }

TEST(PartRefine, RanksWithoutABlockAreNoTrouble) { expect_same(coarse_torus(), 300, 1.35); }

TEST(PartRefine, ThreadsInsideRanksChangeNothing) {
  const LevelSet psi = coarse_torus();
  const std::vector<SsdSample> samples = finer_samples(psi, 6000);
  BandReport report;
  std::optional<LevelSet> first;
  for (const std::size_t n : {1, 3}) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, n);
    const LevelSet made = refine_parts(
        MPI_COMM_WORLD, psi, part_of(psi, samples), {.01, .1, 100}, [](double) {}, report);
    if (!first) first = made;
    EXPECT_TRUE(are_equal(*first, made));
  }
}

/// What rank 0 cuts.
struct Band {
  std::vector<SsdSample> samples;
  LatticeBlocks blocks;
};

/// \pre rank 0
Band torus_band() {
  const LevelSet psi = coarse_torus();
  const int half_width = psi.tables().half_width();
  const std::vector<SsdSample> samples = finer_samples(psi, 20000);
  return {samples, LatticeBlocks(finer_lattice(psi), half_width, SsdBand::blocks_of(samples, half_width))};
}

TEST(BandCut, WhatRank0HoldsBesidesMakesItsPieceShorter) {
  if (rank() != 0) return;
  const auto [samples, blocks] = torus_band();
  const std::vector<int> equal = cut_band(blocks, samples, 3), less = cut_band(blocks, samples, 3, 1e9);
  EXPECT_NEAR(less[1], equal[1] / 4., .15 * equal[1]);
  EXPECT_NEAR(less[2] - less[1], blocks.size() - less[2], .2 * blocks.size());
  EXPECT_EQ(less[3], blocks.size());
  EXPECT_EQ(cut_band(blocks, samples, 1, 1e9), (std::vector<int>{0, blocks.size()}));
}

TEST(BandCut, PiecesAreOfEqualWorkAndKnowWhatIsNextToThem) {
  if (rank() != 0) return;
  const auto [samples, blocks] = torus_band();
  const std::vector<int> begin = cut_band(blocks, samples, 3);
  ASSERT_EQ(begin.size(), 4U);
  EXPECT_EQ(begin.front(), 0);
  EXPECT_EQ(begin.back(), blocks.size());
  const std::vector<std::size_t> runs = block_runs(samples);
  const auto of_ranks = runs_of_ranks(blocks, begin, samples, runs);
  for (int r = 0; r < 3; ++r) {
    const int n = begin[r + 1] - begin[r];
    EXPECT_NEAR(n, blocks.size() / 3., .2 * blocks.size());
    const std::vector<int> known = with_neighbours(blocks, begin[r], begin[r + 1]);
    EXPECT_LT(known.size(), static_cast<std::size_t>(blocks.size()));
    for (int b = begin[r]; b < begin[r + 1]; ++b) {
      EXPECT_EQ(rank_of_block(begin, b), r);
      EXPECT_TRUE(std::binary_search(known.begin(), known.end(), b));
    }
    EXPECT_LT(of_ranks[r].size(), runs.size() - 1);
  }
}

}  // namespace
}  // namespace umtet
