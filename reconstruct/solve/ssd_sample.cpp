#include "reconstruct/solve/ssd_sample.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace umtet {

namespace {

struct Keyed {
  std::uint64_t key;
  std::uint32_t index;
  bool operator<(const Keyed& o) const { return key != o.key ? key < o.key : index < o.index; }
};

// Block of cells (17 bits an axis), then cube in the block (4 bits an axis: at most 16 cubes along 8 cells).
std::uint64_t key_of(const Eigen::Vector3d& xi, double cubes_per_cell) {
  std::uint64_t block = 0, inner = 0;
  const auto per_block = static_cast<std::uint64_t>(8 * cubes_per_cell);
  for (int d = 2; d >= 0; --d) {
    const auto q = static_cast<std::uint64_t>(xi[d] * cubes_per_cell);
    block = block << 17 | q / per_block;
    inner = inner * per_block + q % per_block;
  }
  return block << 12 | inner;
}

// What a sample counts in the mean of several: a value without a normal has no w_gradient.
double share_of(const SsdSample& s) { return s.w_gradient > 0 ? s.w_gradient : s.w_value; }

}  // namespace

SampleColumns::SampleColumns(const std::vector<SsdSample>& samples) {
  places.reserve(samples.size());
  normals.reserve(samples.size());
  areas.reserve(samples.size());
  for (const SsdSample& s : samples) {
    places.push_back(s.xi);
    normals.push_back(s.normal);
    areas.push_back(s.w_gradient);
  }
}

std::vector<SsdSample> merge_samples(const std::vector<SsdSample>& samples, double cube) {
  std::vector<Keyed> order(samples.size());
  tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t i) {
    order[i] = {key_of(samples[i].xi, 1 / cube), static_cast<std::uint32_t>(i)};
  });
  tbb::parallel_sort(order.begin(), order.end());
  std::vector<SsdSample> means;
  means.reserve(order.size());  // memory that is not written costs nothing
  for (std::size_t i = 0; i < order.size();) {
    std::size_t end = i + 1;
    while (end < order.size() && order[end].key == order[i].key) ++end;
    if (end == i + 1) {
      means.push_back(samples[order[i++].index]);
      continue;
    }
    SsdSample mean{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    double shares = 0;
    mean.gap2 = samples[order[i].index].gap2;
    for (std::size_t k = i; k < end; ++k) {
      const SsdSample& s = samples[order[k].index];
      const double share = share_of(s);
      mean.xi += share * s.xi;
      mean.normal += share * s.normal;
      mean.w_value += s.w_value;
      mean.w_gradient += s.w_gradient;
      shares += share;
      mean.gap2 = std::min(mean.gap2, s.gap2);
    }
    mean.xi /= shares;
    mean.normal /= shares;
    for (std::size_t k = i; k < end; ++k) {
      const SsdSample& s = samples[order[k].index];
      mean.value += share_of(s) * (s.value + s.normal.dot(mean.xi - s.xi) / 2);
    }
    mean.value /= shares;
    means.push_back(mean);
    i = end;
  }
  return means;
}

void coarsen(std::vector<SsdSample>& samples) {
  for (SsdSample& s : samples) {
    s.xi /= 2;
    s.value /= 2;
    s.w_value /= 4;
    s.w_gradient /= 4;
    s.gap2 /= 4;
  }
}

}  // namespace umtet
