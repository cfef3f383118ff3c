#include "reconstruct/solve/noise_bias.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace umtet {
namespace {

// |grad psi| of a distance is 1. Where it is less than half, sheets are near each other and H means nothing.
constexpr double kLeastSlope = .5;
// Of so many samples, evenly picked, the mean is known to some per cent.
constexpr std::size_t kSamples = 5000;

}  // namespace

double noise_bias(const LevelSet& psi, const OrientedPointCloud& cloud, double noise) {
  const double most = 1 / psi.spacing();
  const std::size_t n = cloud.points.size(), stride = std::max<std::size_t>(1, n / kSamples);
  double sum = 0;
  std::size_t counted = 0;
  for (std::size_t i = 0; i < n; i += stride) {
    Vec3 g;
    Mat3 H;
    const double value = psi.evaluate(cloud.points[i], &g, nullptr);
    psi.evaluate(cloud.points[i] - value * g / std::max(g.squaredNorm(), kLeastSlope), &g, &H);
    const double slope = g.norm();
    if (slope < kLeastSlope) continue;
    const double mean = (H.trace() - g.dot(H * g) / (slope * slope)) / (2 * slope);
    sum += std::clamp(mean, -most, most);
    ++counted;
  }
  return counted > 0 ? noise * noise * sum / static_cast<double>(counted) : 0;
}

LevelSet shifted(const LevelSet& psi, double c) {
  LevelSetLevel coarsest = psi.coarsest();
  for (double& value : coarsest.coefficients) value += c;
  std::vector<LevelSetBand> bands;
  for (int level = 1; level < psi.n_levels(); ++level) bands.push_back(psi.band(level));
  return {psi.prior(), std::move(coarsest), std::move(bands)};
}

}  // namespace umtet
