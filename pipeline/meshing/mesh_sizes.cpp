#include "pipeline/meshing/mesh_sizes.h"

#include <oneapi/tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <utility>

#include "mesh/certify/quality_report.h"

namespace umtet {
namespace {

using Edge = std::array<int, 2>;

Edge edge_of(int i, int j) { return {std::min(i, j), std::max(i, j)}; }

/// Each edge once, ascending.
std::vector<Edge> once(std::vector<Edge> edges) {
  tbb::parallel_sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

std::vector<Edge> edges_of(const TetMesh& mesh) {
  std::vector<Edge> edges;
  edges.reserve(6 * mesh.C.size());
  for (const Tet& t : mesh.C) {
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < a; ++b) edges.push_back(edge_of(t[a], t[b]));
    }
  }
  return once(std::move(edges));
}

double length(const TetMesh& mesh, const Edge& e) { return (mesh.V[e[0]] - mesh.V[e[1]]).norm(); }

}  // namespace

std::vector<double> asked_sizes(const SizeField& sizes, const std::vector<Vec3>& points, const Context& context) {
  std::vector<double> asked(points.size());
  polled_parallel_for(points.size(), kValuesPerPoll, context, [&](std::size_t i) { asked[i] = sizes.at(points[i]); });
  return asked;
}

std::vector<double> mean_edges(const TetMesh& mesh) {
  std::vector<double> sum(mesh.V.size());
  std::vector<int> n(mesh.V.size());
  for (const Edge& e : edges_of(mesh)) {
    const double l = length(mesh, e);
    for (const int i : e) sum[i] += l, ++n[i];
  }
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = n[i] > 0 ? sum[i] / n[i] : 0;
  return sum;
}

SizesReport sizes_report(const TetMesh& mesh, const std::vector<Triangle>& boundary, const std::vector<double>& asked) {
  SizesReport report;
  const auto [least, greatest] = std::minmax_element(asked.begin(), asked.end());
  report.least_asked = *least;
  report.greatest_asked = *greatest;
  std::vector<double> ratio;
  for (const Edge& e : edges_of(mesh)) ratio.push_back(length(mesh, e) / (.5 * (asked[e[0]] + asked[e[1]])));
  tbb::parallel_sort(ratio);
  report.p01 = quantile(ratio, .01);
  report.p50 = quantile(ratio, .5);
  report.p99 = quantile(ratio, .99);
  std::vector<double> lengths;
  for (const Triangle& f : boundary) {
    for (int k = 0; k < 3; ++k) lengths.push_back(length(mesh, edge_of(f[k], f[(k + 1) % 3])));
  }
  if (lengths.empty()) return report;
  const auto [shortest, longest] = std::minmax_element(lengths.begin(), lengths.end());
  report.shortest_boundary_edge = *shortest;
  report.longest_boundary_edge = *longest;
  return report;
}

}  // namespace umtet
