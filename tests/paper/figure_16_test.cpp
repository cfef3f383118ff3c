// Figure 16: the duck's cloud, a node set of the paper's size, and how the zero level set fits the samples.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "mesh/implicit/zero_set.h"
#include "reconstruct/io/point_cloud_io.h"
#include "reconstruct/solve/fit_ssd.h"
#include "tests/support/data_files.h"

using namespace umtet;

namespace {

struct Fit {
  std::size_t nodes;
  double spacing, rms, worst_cos;
  long genus;
  std::size_t components;
};

Fit fit(const OrientedPointCloud& cloud, const SsdParams& params) {
  const SsdFit result = fit_ssd(cloud, params);
  double sum2 = 0, worst_cos = 1;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    Vec3 g;
    const double value = result.psi.evaluate(cloud.points[i], &g, nullptr);
    sum2 += std::pow(value / g.norm(), 2);
    worst_cos = std::min(worst_cos, g.normalized().dot(cloud.normals[i]));
  }
  const ZeroSetTopology zero =
      zero_set_topology(ImplicitFunctionRef(result.psi), result.psi.domain(), result.report.spacing / 2);
  return {result.report.n_nodes,
          result.report.spacing,
          std::sqrt(sum2 / static_cast<double>(cloud.points.size())),
          worst_cos,
          zero.components.empty() ? -1 : zero.components.front().genus,
          zero.components.size()};
}

}  // namespace

TEST(Figure16, ZeroLevelSetFitsTheDuck) {
  const OrientedPointCloud cloud = read_point_cloud(test::duck_cloud()).cloud;
  ASSERT_EQ(cloud.points.size(), 5344u);
  Eigen::AlignedBox3d box;
  for (const Vec3& x : cloud.points) box.extend(x);
  const double diagonal = box.diagonal().norm();

  SsdParams paper;  // m = 3,550 nodes there, gamma = 1.6, epsilon = 1e-4, eq. (10) with weights 1
  paper.prior = LmePrior::paper();
  paper.weights = SsdWeights::Paper;
  paper.solver = SsdSolver::Full;
  paper.spacing = 0.055 * diagonal;
  paper.padding = 2;
  const Fit like_paper = fit(cloud, paper), ours = fit(cloud, SsdParams{});
  std::printf(
      "Figure 16 (duck, 5344 points)  nodes   spacing/diagonal   rms distance/diagonal   least cos(normal)   genus\n");
  std::printf(
      "  the paper's functions     %7zu   %.4f             %.2e                %.3f               %ld  (paper: 3550 "
      "nodes, genus 1)\n",
      like_paper.nodes, like_paper.spacing / diagonal, like_paper.rms / diagonal, like_paper.worst_cos,
      like_paper.genus);
  std::printf("  default                   %7zu   %.4f             %.2e                %.3f               %ld\n",
              ours.nodes, ours.spacing / diagonal, ours.rms / diagonal, ours.worst_cos, ours.genus);

  EXPECT_GT(like_paper.nodes, 3000u);
  EXPECT_LT(like_paper.nodes, 4300u);
  EXPECT_EQ(like_paper.genus, 1);
  EXPECT_LT(like_paper.rms, 1e-3 * diagonal);
  EXPECT_EQ(ours.genus, 1);
  EXPECT_EQ(ours.components, 1u);
  EXPECT_LT(ours.rms, 1.5e-4 * diagonal);
  EXPECT_LT(ours.rms, like_paper.rms);
}
