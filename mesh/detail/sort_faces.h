#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

#include "mesh/tet_mesh.h"

namespace umtet::detail {

/// Sorts faces as triples of vertices: into groups of one first vertex by counting, then in these groups, which are
/// small. \pre indices in 0 .. n_vertices - 1
inline void sort_faces(std::vector<Triangle>& faces, std::size_t n_vertices) {
  std::vector<std::size_t> begin(n_vertices + 1, 0);
  for (const Triangle& f : faces) ++begin[static_cast<std::size_t>(f[0]) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  std::vector<Triangle> sorted(faces.size());
  for (const Triangle& f : faces) sorted[next[f[0]]++] = f;
  for (std::size_t v = 0; v < n_vertices; ++v) {
    if (begin[v + 1] - begin[v] < 2) continue;
    std::sort(sorted.begin() + static_cast<std::ptrdiff_t>(begin[v]),
              sorted.begin() + static_cast<std::ptrdiff_t>(begin[v + 1]));
  }
  faces.swap(sorted);
}

}  // namespace umtet::detail
