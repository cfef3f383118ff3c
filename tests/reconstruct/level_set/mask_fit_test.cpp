// psi of segmentations: volumes, pieces and signs.

#include "reconstruct/level_set/mask_fit.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "reconstruct/level_set/voxel_pieces.h"
#include "tests/support/label_volumes.h"

using namespace umtet;

namespace {

struct Body {
  std::string name;
  Grid image;
};

/// What a kernel of a voxel makes smaller by 4 to 100 %, and what it leaves.
std::vector<Body> bodies() {
  const Vec3 cube = Vec3::Ones();
  const auto volume = [](int n, const Vec3& steps, const std::function<double(const Vec3&)>& f) {
    return label_volume_of(Eigen::Vector3i::Constant(n), steps, f);
  };
  return {
      {"ball of 3.6 voxels", volume(12, cube, [](const Vec3& x) { return is_in_ball(x, 3.6); })},
      {"ball of 11 voxels", volume(26, cube, [](const Vec3& x) { return is_in_ball(x - Vec3(.3, .2, 0), 11); })},
      {"vessel of 2.5 voxels", volume(36, cube, [](const Vec3& x) { return is_in_vessel(x, 2.5, 15); })},
      {"vessel of 1.2 voxels", volume(36, cube, [](const Vec3& x) { return is_in_vessel(x, 1.2, 15); })},
      {"plate of 1.5 voxels", volume(34, cube, [](const Vec3& x) { return is_in_plate(x, 1.5, 14); })},
      {"shell of 1.6 voxels", volume(34, cube, [](const Vec3& x) { return is_in_shell(x, 12.4, 14); })},
      {"box", volume(24, cube, [](const Vec3& x) { return x.cwiseAbs().maxCoeff() < 8 ? 1. : 0.; })},
      {"ball in long voxels", volume(24, Vec3(1, 1, 3), [](const Vec3& x) { return is_in_ball(x, 10); })},
      {"shell in flat voxels", volume(30, Vec3(1, 1, .5), [](const Vec3& x) { return is_in_shell(x, 4, 5.6); })},
  };
}

/// psi at points between voxels, `finer` as many along each axis, as a mask of what is inside.
VoxelMask sampled(const MaskFit& fit, int finer) {
  const BodyVoxels& voxels = fit.voxels;
  VoxelMask mask;
  mask.n = finer * (voxels.mask.n.array() - 1).matrix();
  for (int k = 0; k < mask.n[2]; ++k) {
    for (int j = 0; j < mask.n[1]; ++j) {
      for (int i = 0; i < mask.n[0]; ++i) {
        const Vec3 at = (Vec3(i, j, k) + Vec3::Constant(.5)) / finer;
        mask.inside.push_back(fit.psi.value(voxels.origin + voxels.axes * at) < 0 ? 1 : 0);
      }
    }
  }
  return mask;
}

Grid mask_of_ball(int n) {
  return label_volume_of(Eigen::Vector3i::Constant(n), Vec3::Constant(2.6 / (n - 1)),
                         [](const Vec3& x) { return x.norm() < 1 ? 3. : 0.; });
}

std::vector<Vec3> directions(int n) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<Vec3> all;
  for (int i = 0; i < n; ++i) all.push_back(Vec3(normal(random), normal(random), normal(random)).normalized());
  return all;
}

}  // namespace

TEST(MaskFit, EveryBodyKeepsItsVolumeAndEveryVoxelItsSide) {
  for (const Body& body : bodies()) {
    const MaskFit fit = fit_mask(body.image, std::nullopt);
    const MaskReport& r = fit.report;
    EXPECT_NEAR(r.volume, r.volume_of_voxels, .005 * r.volume_of_voxels) << body.name;
    EXPECT_EQ(r.n_changed, 0U) << body.name;
    for (int k = 0; k < body.image.n[2]; ++k) {
      const Vec3 x = body.image.origin + body.image.axes * Vec3(body.image.n[0] / 2, body.image.n[1] / 3, k);
      const auto at = static_cast<std::size_t>(body.image.n[0] / 2) +
                      body.image.n[0] * (body.image.n[1] / 3 + static_cast<std::size_t>(body.image.n[1]) * k);
      EXPECT_EQ(fit.psi.value(x) < 0, body.image.values[at] != 0) << body.name << ' ' << k;
    }
  }
}

TEST(MaskFit, TheVolumeIsThatOfTheFunctionBetweenVoxels) {
  for (const Body& body : bodies()) {
    const MaskFit fit = fit_mask(body.image, std::nullopt);
    const VoxelMask fine = sampled(fit, 8);
    const auto n = static_cast<double>(std::count(fine.inside.begin(), fine.inside.end(), 1));
    EXPECT_NEAR(n / 512 * fit.voxels.voxel_volume(), fit.report.volume, .01 * fit.report.volume) << body.name;
  }
}

TEST(MaskFit, ThinBodiesHoldTogether) {
  for (const Body& body : bodies()) {
    const VoxelMask fine = sampled(fit_mask(body.image, std::nullopt), 3);
    const std::size_t outside = body.name.find("shell") == std::string::npos ? 1 : 2;
    EXPECT_EQ(voxel_pieces(fine, 1, VoxelNeighbours::Faces).n(), 1U) << body.name;
    EXPECT_EQ(voxel_pieces(fine, 0, VoxelNeighbours::Faces).n(), outside) << body.name;
  }
}

TEST(MaskFit, ANarrowGapStaysOpen) {
  const Grid image = label_volume_of(Eigen::Vector3i::Constant(36), Vec3::Ones(),
                                     [](const Vec3& x) { return is_in_ball(x, 15) - is_in_shell(x, 9, 10.5); });
  const VoxelMask fine = sampled(fit_mask(image, std::nullopt), 3);
  EXPECT_EQ(voxel_pieces(fine, 1, VoxelNeighbours::Faces).n(), 2U);
}

TEST(MaskFit, EachPieceKeepsItsVolume) {
  const Grid image = label_volume_of({40, 20, 20}, Vec3::Ones(), [](const Vec3& x) {
    return is_in_ball(x - Vec3(-9, 0, 0), 8) + is_in_ball(x - Vec3(9, 0, 0), 2.6);
  });
  const MaskFit fit = fit_mask(image, std::nullopt);
  const VoxelMask fine = sampled(fit, 4);
  const VoxelPieces pieces = voxel_pieces(fine, 1, VoxelNeighbours::Faces);
  const VoxelPieces of_voxels = voxel_pieces(fit.voxels.mask, 1, VoxelNeighbours::Faces);
  ASSERT_EQ(pieces.n(), 2U);
  const std::size_t small = pieces.n_voxels[0] < pieces.n_voxels[1] ? 0 : 1;
  const std::size_t small_voxels = of_voxels.n_voxels[0] < of_voxels.n_voxels[1] ? 0 : 1;
  EXPECT_NEAR(static_cast<double>(pieces.n_voxels[small]) / 64, static_cast<double>(of_voxels.n_voxels[small_voxels]),
              .02 * static_cast<double>(of_voxels.n_voxels[small_voxels]));
}

TEST(MaskFit, ABallIsRound) {
  const MaskFit fit = fit_mask(mask_of_ball(48), std::nullopt);
  double sum = 0;
  for (const Vec3& x : directions(500)) {
    Vec3 g;
    EXPECT_LT(std::abs(fit.psi.evaluate(x, &g, nullptr)), .5 * fit.voxels.steps()[0]);
    sum += (g.normalized() - x).squaredNorm();
  }
  EXPECT_LT(std::sqrt(sum / 500), .07);  // radians: a kernel of a voxel leaves as much
}

TEST(MaskFit, ThreadsChangeNothing) {
  const Grid image = mask_of_ball(20);
  const auto values_with = [&](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return fit_mask(image, std::nullopt).psi.in_nodes().coarsest().coefficients;
  };
  EXPECT_EQ(values_with(1), values_with(4));
}

TEST(MaskFit, APartIsChosenByItsNumber) {
  Grid mask = mask_of_ball(24);
  for (std::size_t i = 0; i < mask.size() / 2; ++i) mask.values[i] *= 2;  // below z = 0: part 6
  const MaskFit lower = fit_mask(mask, 6), whole = fit_mask(mask, std::nullopt);
  EXPECT_GT(lower.psi.value({0, 0, .3}), 0);
  EXPECT_LT(lower.psi.value({0, 0, -.3}), 0);
  EXPECT_LT(whole.psi.value({0, 0, .3}), 0);
  EXPECT_THROW(fit_mask(mask, 5), std::invalid_argument);
}

TEST(MaskFit, APartThatTouchesTheWallOfTheImageEndsThere) {
  const Grid image = label_volume_of(Eigen::Vector3i::Constant(12), Vec3::Constant(2.6 / 11),
                                     [](const Vec3& x) { return x.x() > 0 ? 1. : 0.; });
  const MaskFit fit = fit_mask(image, std::nullopt);
  EXPECT_LT(fit.psi.value({1, 0, 0}), 0);
  EXPECT_GT(fit.psi.value({1.9, 0, 0}), 0);
  EXPECT_GT(fit.psi.box().max().x(), 2);
  EXPECT_NEAR(fit.report.volume, fit.report.volume_of_voxels, .01 * fit.report.volume_of_voxels);
}

TEST(MaskFit, TurnedAxesTurnTheBody) {
  Grid image = mask_of_ball(20);
  const MaskFit straight = fit_mask(image, std::nullopt);
  const Mat3 turn = Eigen::AngleAxisd(.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  image.axes = turn * image.axes;
  image.origin = turn * image.origin;
  const MaskFit turned = fit_mask(image, std::nullopt);
  EXPECT_NEAR(turned.report.volume, straight.report.volume, 1e-4 * straight.report.volume);
  for (const Vec3& x : directions(50)) EXPECT_NEAR(turned.psi.value(turn * x), straight.psi.value(x), 1e-4);
}

TEST(MaskFitByKernel, ASegmentationComesOutSmooth) {
  const int n = 48;
  const double step = 2.6 / (n - 1);
  const MaskFit fit = fit_mask_by_kernel(mask_of_ball(n), std::nullopt, 1);
  EXPECT_LT(fit.report.n_changed, fit.report.n_inside / 50);
  EXPECT_LT(fit.report.farthest_changed, .5 * step);
  double worst = 0, worst_raw = 0;
  const MaskFit raw = fit_mask_by_kernel(mask_of_ball(n), std::nullopt, 0);
  EXPECT_EQ(raw.report.n_changed, 0U);
  for (const Vec3& x : directions(500)) {
    Vec3 g;
    EXPECT_LT(std::abs(fit.psi.evaluate(x, &g, nullptr)), .5 * step);
    worst = std::max(worst, (g.normalized() - x).norm());
    raw.psi.evaluate(x, &g, nullptr);
    worst_raw = std::max(worst_raw, (g.normalized() - x).norm());
  }
  EXPECT_LT(worst, .2);  // radians
  EXPECT_GT(worst_raw, 2 * worst);
}
