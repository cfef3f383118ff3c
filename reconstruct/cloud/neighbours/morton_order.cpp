#include "reconstruct/cloud/neighbours/morton_order.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include <algorithm>
#include <compare>
#include <cstddef>
#include <limits>
#include <utility>

#include "common/first_touch.h"
#include "reconstruct/cloud/cloud_arrays.h"

namespace umtet {
namespace {

template <class T>
void permute(const std::vector<std::uint32_t>& order, std::vector<T>& values) {
  std::vector<T> sorted = touched<T>(order.size());
  tbb::parallel_for(std::size_t{0}, order.size(), [&](std::size_t row) { sorted[row] = values[order[row]]; });
  values = std::move(sorted);
}

}  // namespace

std::uint64_t spread_bits(std::uint64_t v) {
  v = (v | v << 32) & 0x001f00000000ffff;
  v = (v | v << 16) & 0x001f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  return (v | v << 2) & 0x1249249249249249;
}

std::vector<std::uint32_t> morton_order(const std::vector<Vec3>& points) {
  constexpr double kCells = (1 << 21) - 1;
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Vec3& x : points) {
    if (!x.allFinite()) continue;
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const double side = (high - low).maxCoeff(), cells_per_length = side > 0 ? kCells / side : 0;
  struct Key {
    std::uint64_t code;
    std::uint32_t point;
  };
  std::vector<Key> keys = touched<Key>(points.size());
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    std::uint64_t code = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double cell = (points[i][axis] - low[axis]) * cells_per_length;
      if (cell > 0) code |= spread_bits(static_cast<std::uint64_t>(std::min(cell, kCells))) << axis;
    }
    keys[i] = {code, static_cast<std::uint32_t>(i)};
  });
  tbb::parallel_sort(keys.begin(), keys.end(), [&](const Key& a, const Key& b) {
    if (a.code != b.code) return a.code < b.code;
    const Vec3 &x = points[a.point], &y = points[b.point];
    for (int axis = 0; axis < 3; ++axis) {
      const std::strong_ordering order = std::strong_order(x[axis], y[axis]);  // of what is not finite, too
      if (order != 0) return order < 0;
    }
    return a.point < b.point;
  });
  std::vector<std::uint32_t> order = touched<std::uint32_t>(points.size());
  tbb::parallel_for(std::size_t{0}, keys.size(), [&](std::size_t row) { order[row] = keys[row].point; });
  return order;
}

void sort_in_space(OrientedPointCloud& cloud) {
  const std::vector<std::uint32_t> order = morton_order(cloud.points);
  for_each_array(cloud, [&order](auto& array, const std::string&) { permute(order, array); });
}

}  // namespace umtet
