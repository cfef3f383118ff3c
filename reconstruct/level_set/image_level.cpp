#include "reconstruct/level_set/image_level.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace umtet {
namespace {

constexpr int kBins = 1024;

/// The same with at most two digits, if it stays between.
double with_few_digits(double v, double low, double high) {
  for (int digits = 1; digits <= 6 && v != 0; ++digits) {
    const double unit = std::pow(10., std::floor(std::log10(std::abs(v))) - digits + 1);
    const double rounded = unit >= 1 ? std::round(v / unit) * unit : std::round(v / unit) / std::round(1 / unit);
    // A tenth of the way between both classes does not change much.
    if (std::abs(rounded - v) <= .1 * (high - low)) return rounded;
  }
  return v;
}

/// Mean change a length between neighbours along an axis whose values have two signs.
double slope_at_zero(const Grid& grid) {
  const std::ptrdiff_t strides[] = {1, grid.n[0], static_cast<std::ptrdiff_t>(grid.n[0]) * grid.n[1]};
  const Vec3 steps = grid.steps();
  double sum = 0;
  std::size_t n = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (std::ptrdiff_t at = 0; at < static_cast<std::ptrdiff_t>(grid.size()); ++at) {
      if (at / strides[axis] % grid.n[axis] + 1 == grid.n[axis]) continue;
      const double a = grid.values[at], b = grid.values[at + strides[axis]];
      if ((a < 0) == (b < 0)) continue;
      sum += std::abs(a - b) / steps[axis];
      ++n;
    }
  }
  if (n > 0) return sum / static_cast<double>(n);
  const auto [least, greatest] = std::minmax_element(grid.values.begin(), grid.values.end());
  return std::max(std::abs(*least), std::abs(*greatest)) / steps.minCoeff();
}

}  // namespace

double suggested_level(const Grid& grid) {
  const auto [least, greatest] = std::minmax_element(grid.values.begin(), grid.values.end());
  const double low = *least, range = *greatest - low;
  if (!(range > 0)) return low;
  std::array<double, kBins> count{}, sum{};
  for (const double v : grid.values) {
    const auto bin = static_cast<std::size_t>(std::min<double>(kBins - 1, std::floor((v - low) / range * kBins)));
    ++count[bin], sum[bin] += v - low;
  }
  double n_all = 0, sum_all = 0;
  for (int b = 0; b < kBins; ++b) n_all += count[b], sum_all += sum[b];
  double n = 0, s = 0, best = -1, dark = 0, bright = range;
  for (int b = 0; b + 1 < kBins; ++b) {
    n += count[b], s += sum[b];
    if (n == 0 || n == n_all) continue;
    const double mean = s / n, mean_above = (sum_all - s) / (n_all - n);
    const double between = n * (n_all - n) * (mean - mean_above) * (mean - mean_above);
    if (between > best) best = between, dark = mean, bright = mean_above;
  }
  return with_few_digits(low + .5 * (dark + bright), low + dark, low + bright);
}

void take_above(Grid& grid, double low) {
  for (double& v : grid.values) v = low - v;
}

void take_below(Grid& grid, double high) {
  for (double& v : grid.values) v -= high;
}

void take_between(Grid& grid, double low, double high) {
  for (double& v : grid.values) v = (v - low) * (v - high) / (high - low);
}

bool close_at_wall(Grid& grid, int layers) {
  if (wall_share(grid, [](double v) { return v < 0; }) == 0) return false;
  const double slope = slope_at_zero(grid);
  const Vec3 steps = grid.steps();
  Grid wide;
  wide.n = grid.n + Eigen::Vector3i::Constant(2 * layers);
  wide.axes = grid.axes;
  wide.origin = grid.origin - grid.axes * Vec3::Constant(layers);
  wide.values.resize(wide.size());
  std::size_t at = 0;
  for (int k = 0; k < wide.n[2]; ++k) {
    for (int j = 0; j < wide.n[1]; ++j) {
      for (int i = 0; i < wide.n[0]; ++i) {
        const Eigen::Vector3i node = Eigen::Vector3i(i, j, k).array() - layers;
        const Eigen::Vector3i near = node.cwiseMax(0).cwiseMin((grid.n.array() - 1).matrix());
        const double v = grid.values[near[0] + grid.n[0] * (near[1] + static_cast<std::size_t>(grid.n[1]) * near[2])];
        // Along each axis how far beyond the wall.
        const Vec3 beyond = ((node.cast<double>().array() - .5 * (grid.n.array() - 1).cast<double>()).abs() -
                             .5 * grid.n.array().cast<double>()) *
                            steps.array();
        const double d = beyond.maxCoeff() <= 0 ? beyond.maxCoeff() : beyond.cwiseMax(0).norm();
        wide.values[at++] = std::max(v, slope * d);
      }
    }
  }
  grid.values = std::move(wide.values);
  grid.n = wide.n;
  grid.origin = wide.origin;
  return true;
}

}  // namespace umtet
