#include "body/fidelity/mesh_sizes.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <numeric>

#include "common/polled_loops.h"
#include "mesh/certify/quality_report.h"

namespace umtet {
namespace {

// Vertices whose edges are listed together, and tets whose range of vertices is known: lists of a few MB.
constexpr std::size_t kLowEnds = 1 << 14, kTets = 1 << 10;
// Lists that are made at once, for threads.
constexpr std::size_t kAtOnce = 16;

/// The edges of tets, each once, listed by parts: those with the lower end in a range of vertices. Tets of neighbouring
/// places have neighbouring numbers mostly, so that a part has to look at few of them.
class TetEdges {
 public:
  TetEdges(std::size_t n_vertices, const std::vector<Tet>& C)
      : n_vertices_(n_vertices), C_(C), blocks_((C.size() + kTets - 1) / kTets) {
    tbb::parallel_for(std::size_t{0}, blocks_.size(), [&](std::size_t b) {
      for_each_tet(b, [&](const Tet& t) {
        for (const int v : t) blocks_[b] = {std::min(blocks_[b].least, v), std::max(blocks_[b].greatest, v)};
      });
    });
  }

  std::size_t n_parts() const { return (n_vertices_ + kLowEnds - 1) / kLowEnds; }

  /// Calls f(low, high) for the edges of a part, ascending.
  template <class F>
  void for_each(std::size_t part, const F& f) const {
    const auto first = static_cast<int>(part * kLowEnds);
    const int last = static_cast<int>(std::min(n_vertices_, (part + 1) * kLowEnds));
    const auto for_each_end = [&](const auto& g) {
      for (std::size_t b = 0; b < blocks_.size(); ++b) {
        if (blocks_[b].greatest < first || blocks_[b].least >= last) continue;
        for_each_tet(b, [&](const Tet& t) {
          for (int j = 0; j < 4; ++j) {
            for (int k = 0; k < j; ++k) {
              const auto [low, high] = std::minmax(t[j], t[k]);
              if (first <= low && low < last) g(low, high);
            }
          }
        });
      }
    };
    std::vector<std::size_t> end(static_cast<std::size_t>(last - first) + 1, 0);
    for_each_end([&](int low, int) { ++end[static_cast<std::size_t>(low - first) + 1]; });
    std::partial_sum(end.begin(), end.end(), end.begin());
    std::vector<int> upper(end.back());
    for_each_end([&](int low, int high) { upper[end[static_cast<std::size_t>(low - first)]++] = high; });
    auto begin = upper.begin();
    for (int low = first; low < last; ++low) {
      const auto of_next = upper.begin() + static_cast<std::ptrdiff_t>(end[static_cast<std::size_t>(low - first)]);
      std::sort(begin, of_next);
      std::for_each(begin, std::unique(begin, of_next), [&](int high) { f(low, high); });
      begin = of_next;
    }
  }

 private:
  struct Range {
    int least = std::numeric_limits<int>::max(), greatest = -1;
  };
  template <class F>
  void for_each_tet(std::size_t block, const F& f) const {
    for (std::size_t t = block * kTets; t < std::min(C_.size(), (block + 1) * kTets); ++t) f(C_[t]);
  }

  std::size_t n_vertices_;
  const std::vector<Tet>& C_;
  std::vector<Range> blocks_;
};

/// f(low, high) of every edge.
template <class F>
std::vector<double> values_of_edges(const TetMesh& mesh, const F& f) {
  const TetEdges edges(mesh.V.size(), mesh.C);
  std::vector<double> values;
  values.reserve(mesh.V.size() + mesh.C.size() + mesh.C.size() / 8);  // Euler: V + T + boundary faces / 2
  for (std::size_t part = 0; part < edges.n_parts(); part += kAtOnce) {
    std::array<std::vector<double>, kAtOnce> of_part;
    tbb::parallel_for(part, std::min(edges.n_parts(), part + kAtOnce), [&](std::size_t p) {
      edges.for_each(p, [&](int low, int high) { of_part[p - part].push_back(f(low, high)); });
    });
    for (const std::vector<double>& some : of_part) values.insert(values.end(), some.begin(), some.end());
  }
  return values;
}

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
  const TetEdges edges(V.size(), C);
  for (std::size_t part = 0; part < edges.n_parts(); ++part) {
    edges.for_each(part, [&](int i, int j) {
      const double l = length(V, i, j);
      for (const int v : {i, j}) sum[v] += l, ++n[v];
    });
  }
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = n[i] > 0 ? sum[i] / n[i] : 0;
  return sum;
}

SizesReport sizes_report(const TetMesh& mesh, const std::vector<Triangle>& boundary, const std::vector<double>& asked) {
  SizesReport report;
  const auto [least, greatest] = std::minmax_element(asked.begin(), asked.end());
  report.least_asked = *least;
  report.greatest_asked = *greatest;
  std::vector<double> ratio =
      values_of_edges(mesh, [&](int i, int j) { return length(mesh.V, i, j) / (.5 * (asked[i] + asked[j])); });
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
