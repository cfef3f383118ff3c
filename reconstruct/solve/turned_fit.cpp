#include "reconstruct/solve/turned_fit.h"

#include <tbb/parallel_for.h>

#include <utility>

namespace umtet {
namespace {

// Each fit turns most of what is left, or there is no surface to turn to.
constexpr int kRounds = 4;

void turn_opposed(OrientedPointCloud& cloud, const LevelSet& psi) {
  tbb::parallel_for(std::size_t{0}, cloud.points.size(), [&](std::size_t i) {
    Vec3 gradient;
    psi.evaluate(cloud.points[i], &gradient, nullptr);
    if (gradient.dot(cloud.normals[i]) < 0) cloud.normals[i] = -cloud.normals[i];
  });
}

}  // namespace

double opposed_share(const SsdReport& report) {
  return static_cast<double>(report.n_opposed_normals) / static_cast<double>(report.n_points);
}

SsdFit fit_turning_opposed(OrientedPointCloud& cloud, const SsdParams& params, const Context& context,
                           const NeighbourDistances* near) {
  SsdFit fit = fit_ssd(cloud, params, context, near);
  for (int round = 0; round < kRounds && opposed_share(fit.report) > kMostOpposed; ++round) {
    OrientedPointCloud turned = cloud;
    turn_opposed(turned, fit.psi);
    SsdFit again = fit_ssd(turned, params, context, near);
    if (again.report.n_opposed_normals >= fit.report.n_opposed_normals) break;
    again.report.n_turned_normals = fit.report.n_turned_normals + fit.report.n_opposed_normals;
    cloud = std::move(turned);
    fit = std::move(again);
  }
  return fit;
}

}  // namespace umtet
