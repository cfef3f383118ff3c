#include "pipeline/output/detail/worst_tets.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace umtet::detail {
namespace {

constexpr std::size_t kTetsPerTask = 1 << 16;  // some hundreds of microseconds

auto worse_by(const std::vector<double>& quality) {
  return [&quality](int a, int b) { return quality[a] != quality[b] ? quality[a] < quality[b] : a < b; };
}

void sort_first(const std::vector<double>& quality, std::size_t n, std::vector<int>& tets) {
  std::partial_sort(tets.begin(), tets.begin() + static_cast<std::ptrdiff_t>(n), tets.end(), worse_by(quality));
}

}  // namespace

std::vector<int> worst_first(const std::vector<double>& quality, std::size_t n) {
  std::vector<int> tets(quality.size());
  std::iota(tets.begin(), tets.end(), 0);
  sort_first(quality, n, tets);
  return tets;
}

std::vector<int> worst_of(const std::vector<double>& quality, std::size_t n) {
  std::vector<std::vector<int>> of_tasks((quality.size() + kTetsPerTask - 1) / kTetsPerTask);
  tbb::parallel_for(std::size_t{0}, of_tasks.size(), [&](std::size_t task) {
    const std::size_t first = task * kTetsPerTask;
    std::vector<int> tets(std::min(kTetsPerTask, quality.size() - first));
    std::iota(tets.begin(), tets.end(), static_cast<int>(first));
    if (tets.size() > n) {
      std::nth_element(tets.begin(), tets.begin() + static_cast<std::ptrdiff_t>(n), tets.end(), worse_by(quality));
      tets.resize(n);
    }
    of_tasks[task] = std::move(tets);
  });
  std::vector<int> worst;
  for (const std::vector<int>& some : of_tasks) worst.insert(worst.end(), some.begin(), some.end());
  sort_first(quality, n, worst);
  worst.resize(n);
  return worst;
}

}  // namespace umtet::detail
