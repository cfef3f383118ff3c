#include "pipeline/meshing/mesh_sizes.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>

#include "common/polled_loops.h"
#include "mesh/certify/quality_report.h"

namespace umtet {
namespace {

/// The upper ends of the edges of each vertex to a higher one, ascending, as often as there are tets around them.
class UpperEnds {
 public:
  UpperEnds(std::size_t n_vertices, const std::vector<Tet>& C) : begin_(n_vertices + 1, 0) {
    const auto for_each = [&](const auto& f) {
      for (const Tet& t : C) {
        for (int a = 0; a < 4; ++a) {
          for (int b = 0; b < a; ++b) f(std::min(t[a], t[b]), std::max(t[a], t[b]));
        }
      }
    };
    for_each([&](int low, int) { ++begin_[low + 1]; });
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    upper_.resize(begin_.back());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for_each([&](int low, int high) { upper_[next[low]++] = high; });
    tbb::parallel_for(std::size_t{0}, n_vertices, [&](std::size_t v) {
      std::sort(upper_.begin() + static_cast<std::ptrdiff_t>(begin_[v]),
                upper_.begin() + static_cast<std::ptrdiff_t>(begin_[v + 1]));
    });
  }
  /// Calls f(low, high) once for every edge, ascending.
  template <class F>
  void for_each_edge(const F& f) const {
    for (std::size_t v = 0; v + 1 < begin_.size(); ++v) {
      for (std::size_t k = begin_[v]; k < begin_[v + 1]; ++k) {
        if (k == begin_[v] || upper_[k] != upper_[k - 1]) f(static_cast<int>(v), upper_[k]);
      }
    }
  }

 private:
  std::vector<std::size_t> begin_;
  std::vector<int> upper_;
};

double length(const std::vector<Vec3>& V, int i, int j) { return (V[i] - V[j]).norm(); }

/// quantile() for each p, which ascend, of values in any order, and which leaves them in another. To sort all of them
/// for three numbers would cost as much as the rest of the report.
template <std::size_t N>
std::array<double, N> quantiles(std::vector<double>& values, const std::array<double, N>& p) {
  std::array<double, N> found;
  auto from = values.begin();
  for (std::size_t k = 0; k < N; ++k) {
    const QuantilePlace place = quantile_place(values.size(), p[k]);
    const auto below = values.begin() + static_cast<std::ptrdiff_t>(place.below);
    std::nth_element(from, below, values.end());
    const double above = place.above == place.below ? *below : *std::min_element(below + 1, values.end());
    found[k] = place.of(*below, above);
    from = below;
  }
  return found;
}

}  // namespace

std::vector<double> asked_sizes(const SizeField& sizes, const std::vector<Vec3>& points, const Context& context) {
  std::vector<double> asked(points.size());
  polled_parallel_for(points.size(), kValuesPerPoll, context, [&](std::size_t i) { asked[i] = sizes.at(points[i]); });
  return asked;
}

std::vector<double> mean_edges(const std::vector<Vec3>& V, const std::vector<Tet>& C) {
  std::vector<double> sum(V.size());
  std::vector<int> n(V.size());
  UpperEnds(V.size(), C).for_each_edge([&](int i, int j) {
    const double l = length(V, i, j);
    for (const int v : {i, j}) sum[v] += l, ++n[v];
  });
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = n[i] > 0 ? sum[i] / n[i] : 0;
  return sum;
}

SizesReport sizes_report(const TetMesh& mesh, const std::vector<Triangle>& boundary, const std::vector<double>& asked) {
  SizesReport report;
  const auto [least, greatest] = std::minmax_element(asked.begin(), asked.end());
  report.least_asked = *least;
  report.greatest_asked = *greatest;
  std::vector<double> ratio;
  UpperEnds(mesh.V.size(), mesh.C).for_each_edge([&](int i, int j) {
    ratio.push_back(length(mesh.V, i, j) / (.5 * (asked[i] + asked[j])));
  });
  const auto [p01, p50, p99] = quantiles<3>(ratio, {.01, .5, .99});
  report.p01 = p01;
  report.p50 = p50;
  report.p99 = p99;
  std::vector<double> lengths;
  for (const Triangle& f : boundary) {
    for (int k = 0; k < 3; ++k) lengths.push_back(length(mesh.V, f[k], f[(k + 1) % 3]));
  }
  if (lengths.empty()) return report;
  const auto [shortest, longest] = std::minmax_element(lengths.begin(), lengths.end());
  report.shortest_boundary_edge = *shortest;
  report.longest_boundary_edge = *longest;
  return report;
}

}  // namespace umtet
