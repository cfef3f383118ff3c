#include "reconstruct/solve/fit_measures.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "reconstruct/solve/outer_wall.h"

namespace umtet {
namespace {

constexpr std::size_t kChunk = 4096;  // samples that are summed up in their order
// Samples are sorted in space, and what psi is evaluated from is made where they are: of one stretch at a time. To make
// a block of it costs as much as a few of its hundred samples.
constexpr std::size_t kChunksPerStretch = 64;

/// f(chunk) for all chunks of n samples; of more than a stretch, psi keeps nothing of its evaluations.
template <class F>
void for_each_chunk(std::size_t n, const LevelSet& psi, const F& f) {
  const std::size_t n_chunks = (n + kChunk - 1) / kChunk;
  for (std::size_t first = 0; first < n_chunks; first += kChunksPerStretch) {
    tbb::parallel_for(first, std::min(n_chunks, first + kChunksPerStretch), f);
    if (n_chunks > kChunksPerStretch) psi.forget_below(std::numeric_limits<double>::infinity());
  }
}

}  // namespace

void measure_fit(const OrientedPointCloud& cloud, const LevelSet& psi, const std::vector<double>& area, double length,
                 SsdReport& report) {
  struct Sums {
    double value2 = 0, n = 0, energy_value = 0, energy_normal = 0, area = 0;
    std::size_t n_opposed = 0;
  };
  const std::size_t n = cloud.points.size();
  std::vector<Sums> sums((n + kChunk - 1) / kChunk);
  for_each_chunk(n, psi, [&](std::size_t chunk) {
    Sums& sum = sums[chunk];
    for (std::size_t i = chunk * kChunk; i < std::min(n, (chunk + 1) * kChunk); ++i) {
      const double a = area.empty() ? 1 : area[i], scale = area.empty() ? 1 : length;
      Vec3 gradient;
      const double value = psi.evaluate(cloud.points[i], &gradient, nullptr);
      const double count = cloud.counts.empty() ? 1 : cloud.counts[i];
      const double spread = cloud.spreads.empty() ? 0 : cloud.spreads[i];
      sum.value2 += count * (value * value + spread * spread);
      sum.n += count;
      sum.energy_value += a * std::pow(value / scale, 2) / 2;
      sum.energy_normal += a * (gradient - cloud.normals[i]).squaredNorm() / 2;
      sum.area += a;
      sum.n_opposed += gradient.dot(cloud.normals[i]) < 0;
    }
  });
  double value2 = 0, all = 0, all_counted = 0;
  for (const Sums& sum : sums) {
    value2 += sum.value2;
    all += sum.area;
    all_counted += sum.n;
    report.energy_value += sum.energy_value;
    report.energy_normal += sum.energy_normal;
    report.n_opposed_normals += sum.n_opposed;
  }
  report.rms_value = std::sqrt(value2 / all_counted);
  report.normal_defect = 2 * report.energy_normal / all;

  report.least_wall_value = least_wall_value(psi);
}

}  // namespace umtet
