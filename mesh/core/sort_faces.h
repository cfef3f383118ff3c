#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

#include "mesh/core/tet_mesh.h"

namespace umtet {

/// Sorts faces as triples of vertices. A counting sort makes groups of similar first vertices, about as many as there
/// are faces; each of these small groups is then sorted. \pre indices in 0 .. n_vertices - 1
inline void sort_faces(std::vector<Triangle>& faces, std::size_t n_vertices) {
  int shift = 0;  // from a first vertex to its group
  while (n_vertices >> shift > faces.size()) ++shift;
  std::vector<std::size_t> end((n_vertices >> shift) + 2, 0);
  for (const Triangle& f : faces) ++end[(f[0] >> shift) + 1];
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<Triangle> sorted(faces.size());
  for (const Triangle& f : faces) sorted[end[f[0] >> shift]++] = f;
  std::size_t begin = 0;
  for (const std::size_t e : end) {
    if (e > begin + 1) std::sort(sorted.data() + begin, sorted.data() + e);
    begin = e;
  }
  faces.swap(sorted);
}

}  // namespace umtet
