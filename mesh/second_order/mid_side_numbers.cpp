#include "mesh/second_order/mid_side_numbers.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "mesh/base/check_indices.h"

namespace umtet {

MidSideNumbers::MidSideNumbers(const std::vector<Tet>& C, std::size_t n_vertices) : first_(n_vertices + 1, 0) {
  check_indices(C, n_vertices, "tet");
  std::vector<std::size_t> begin(n_vertices + 2, 0);
  const auto for_edges = [&](const auto& f) {
    for (const Tet& t : C) {
      for (const auto& [p, q] : kMidSideEdge) f(std::min(t[p], t[q]), std::max(t[p], t[q]));
    }
  };
  for_edges([&](int low, int) { ++begin[low + 2]; });
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<int> uses(6 * C.size());  // the higher vertex of every edge of every tet, under the lower one
  for_edges([&](int low, int high) { uses[begin[low + 1]++] = high; });
  const auto at = [&](std::size_t i) { return uses.begin() + static_cast<std::ptrdiff_t>(i); };

  tbb::parallel_for(std::size_t{0}, n_vertices, [&](std::size_t v) {
    std::sort(at(begin[v]), at(begin[v + 1]));
    first_[v + 1] = static_cast<int>(std::unique(at(begin[v]), at(begin[v + 1])) - at(begin[v]));
  });
  const std::int64_t n_edges = std::accumulate(first_.begin(), first_.end(), std::int64_t{0});
  if (n_edges + static_cast<std::int64_t>(n_vertices) > std::numeric_limits<int>::max()) {
    throw std::invalid_argument("a mesh of second order with more than 2^31 nodes");
  }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  higher_.resize(static_cast<std::size_t>(n_edges));
  for (std::size_t v = 0; v < n_vertices; ++v) {
    std::copy_n(at(begin[v]), first_[v + 1] - first_[v], higher_.begin() + first_[v]);
  }
}

int MidSideNumbers::operator()(int a, int b) const {
  const int low = std::min(a, b), high = std::max(a, b);
  if (low < 0 || low + 1 >= static_cast<int>(first_.size())) return -1;
  const auto begin = higher_.begin() + first_[low], end = higher_.begin() + first_[low + 1];
  const auto found = std::lower_bound(begin, end, high);
  return found != end && *found == high ? static_cast<int>(found - higher_.begin()) : -1;
}

QuadraticTetMesh MidSideNumbers::straight_mesh(const TetMesh& mesh) const {
  QuadraticTetMesh result;
  const std::size_t n_corners = mesh.V.size();
  result.V = mesh.V;
  result.V.resize(n_corners + n_edges());
  tbb::parallel_for(std::size_t{0}, n_corners, [&](std::size_t v) {
    for (int e = first_[v]; e < first_[v + 1]; ++e) result.V[n_corners + e] = (mesh.V[v] + mesh.V[higher_[e]]) / 2;
  });
  result.C.resize(mesh.C.size());
  tbb::parallel_for(std::size_t{0}, mesh.C.size(), [&](std::size_t t) {
    QuadraticTet& nodes = result.C[t];
    std::copy(mesh.C[t].begin(), mesh.C[t].end(), nodes.begin());
    for (int k = 0; k < 6; ++k) {
      nodes[4 + k] = static_cast<int>(n_corners) + (*this)(nodes[kMidSideEdge[k][0]], nodes[kMidSideEdge[k][1]]);
    }
  });
  return result;
}

}  // namespace umtet
