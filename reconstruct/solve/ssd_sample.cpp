#include "reconstruct/solve/ssd_sample.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "common/first_touch.h"
#include "common/indices_where.h"
#include "reconstruct/basis/lattice_blocks.h"

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

/// 0, the i at which something begins, and n. @param begins  of 1 .. n - 1
template <class Begins>
std::vector<std::size_t> run_begins(std::size_t n, Begins&& begins) {
  std::vector<std::size_t> all = indices_where<std::size_t>(n, [&](std::size_t i) { return i == 0 || begins(i); });
  all.push_back(n);
  return all;
}

// What a sample counts in the mean of several: a value without a normal has no w_gradient.
double share_of(const SsdSample& s) { return s.w_gradient > 0 ? s.w_gradient : s.w_value; }

/// @param sample  of an index
template <class Sample>
SsdSample mean_of(const Sample& sample, std::span<const Keyed> some) {
  if (some.size() == 1) return sample(some.front().index);
  SsdSample mean{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  double shares = 0;
  mean.gap2 = sample(some.front().index).gap2;
  for (const Keyed& one : some) {
    const SsdSample& s = sample(one.index);
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
  for (const Keyed& one : some) {
    const SsdSample& s = sample(one.index);
    mean.value += share_of(s) * (s.value + s.normal.dot(mean.xi - s.xi) / 2);
  }
  mean.value /= shares;
  return mean;
}

template <class Sample>
std::vector<SsdSample> merged(std::size_t n, const Sample& sample, double cube) {
  std::vector<Keyed> order = touched<Keyed>(n);
  tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
    order[i] = {key_of(sample(i).xi, 1 / cube), static_cast<std::uint32_t>(i)};
  });
  tbb::parallel_sort(order.begin(), order.end());
  const std::vector<std::size_t> cubes =
      run_begins(order.size(), [&](std::size_t i) { return order[i].key != order[i - 1].key; });
  std::vector<SsdSample> means = touched<SsdSample>(cubes.size() - 1);
  tbb::parallel_for(std::size_t{0}, means.size(), [&](std::size_t c) {
    means[c] = mean_of(sample, std::span(order).subspan(cubes[c], cubes[c + 1] - cubes[c]));
  });
  return means;
}

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
  return merged(
      samples.size(), [&](std::size_t i) -> const SsdSample& { return samples[i]; }, cube);
}

std::vector<SsdSample> merge_samples(std::size_t n, const std::function<SsdSample(std::size_t)>& sample, double cube) {
  return merged(n, sample, cube);
}

std::vector<std::size_t> block_runs(const std::vector<SsdSample>& samples) {
  const auto block_of = [&](std::size_t i) -> Eigen::Vector3i { return cell_of(samples[i]) / LatticeBlocks::kEdge; };
  return run_begins(samples.size(), [&](std::size_t i) { return block_of(i) != block_of(i - 1); });
}

SsdSample coarsened(SsdSample s) {
  s.xi /= 2;
  s.value /= 2;
  s.w_value /= 4;
  s.w_gradient /= 4;
  s.gap2 /= 4;
  return s;
}

}  // namespace umtet
