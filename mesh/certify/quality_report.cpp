#include "mesh/certify/quality_report.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "common/first_touch.h"
#include "mesh/core/tet_packs.h"

namespace umtet {
namespace {

// A fraction of a millisecond.
constexpr std::size_t kGroupsPerTask = 1 << 11, kTetsPerTask = 1 << 14;

/// The least of all that threads come with, in whatever order.
void lower(double& least, double value) {
  const std::atomic_ref<double> shared(least);
  double before = shared.load(std::memory_order_relaxed);
  while (value < before && !shared.compare_exchange_weak(before, value, std::memory_order_relaxed)) {
  }
}

}  // namespace

void measure_mean_ratios(const TetMesh& mesh, std::vector<double>& Q, std::size_t first) {
  const std::size_t n = Q.size();
  const auto measure = [&](const tbb::blocked_range<std::size_t>& groups) {
    for (std::size_t at = groups.begin() * kPackSize; at < std::min(n, groups.end() * kPackSize); at += kPackSize) {
      const int count = static_cast<int>(std::min<std::size_t>(kPackSize, n - at));
      const TetPack tets = measure_tet_pack(mesh, &mesh.C[first + at], count);
      for (int m = 0; m < count; ++m) Q[at + m] = tets.quality[m];
    }
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, (n + kPackSize - 1) / kPackSize, kGroupsPerTask), measure);
}

std::vector<double> mean_ratios(const TetMesh& mesh) {
  std::vector<double> Q = touched<double>(mesh.C.size());
  measure_mean_ratios(mesh, Q);
  return Q;
}

QualityVectors quality_vectors(const std::vector<Tet>& C, const std::vector<double>& Q,
                               const std::vector<int>& positive_vertices, std::size_t n_vertices) {
  if (Q.size() != C.size()) throw std::invalid_argument("quality vectors: one Q per tet");
  std::vector<char> is_positive(n_vertices, 0);
  for (const int v : positive_vertices) is_positive[v] = 1;
  constexpr double kNoTet = std::numeric_limits<double>::infinity();
  QualityVectors q = {std::vector<double>(n_vertices, kNoTet), std::vector<double>(n_vertices, kNoTet)};
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, C.size(), kTetsPerTask), [&](const auto& tets) {
    for (std::size_t k = tets.begin(); k != tets.end(); ++k) {
      const Tet& t = C[k];
      for (const int v : t) lower(q.all[v], Q[k]);
      if ((is_positive[t[0]] | is_positive[t[1]] | is_positive[t[2]] | is_positive[t[3]]) == 0) continue;
      for (const int v : t) lower(q.boundary[v], Q[k]);
    }
  });
  for (std::vector<double>* values : {&q.all, &q.boundary}) {
    std::erase(*values, kNoTet);
    tbb::parallel_sort(values->begin(), values->end());
  }
  return q;
}

QuantilePlace quantile_place(std::size_t n, double p) {
  const double at = p * static_cast<double>(n - 1);
  const auto below = static_cast<std::size_t>(at);
  return {below, std::min(below + 1, n - 1), at - static_cast<double>(below)};
}

double QuantilePlace::of(double value_below, double value_above) const {
  return value_below + part * (value_above - value_below);
}

double quantile(const std::vector<double>& lowest, std::size_t n, double p) {
  if (lowest.empty()) return std::numeric_limits<double>::quiet_NaN();
  const QuantilePlace place = quantile_place(n, p);
  return place.of(lowest[place.below], lowest[place.above]);
}

double quantile(const std::vector<double>& ascending, double p) { return quantile(ascending, ascending.size(), p); }

}  // namespace umtet
