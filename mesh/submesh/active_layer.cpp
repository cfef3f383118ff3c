#include "mesh/submesh/active_layer.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

#include "common/first_touch.h"

namespace umtet {
namespace {

// Tets of one part are counted and listed by one thread: each part needs a counter a vertex. Patches have one part.
constexpr std::size_t kTetsPerPart = 1 << 16, kMostParts = 8;
constexpr std::size_t kVerticesPerBlock = 1 << 13;

}  // namespace

void list_rings(ActiveLayer& layer) {
  const std::size_t n_tets = layer.C.size(), n_vertices = layer.V.size();
  const std::size_t n_parts = std::clamp<std::size_t>(n_tets / kTetsPerPart, 1, kMostParts);
  std::vector<std::vector<int>> next(n_parts);  // per part: how many tets of a vertex, then where they go
  const auto for_each_corner = [&](std::size_t part, const auto& f) {
    for (std::size_t t = n_tets * part / n_parts; t < n_tets * (part + 1) / n_parts; ++t) {
      for (const int v : layer.C[t]) f(static_cast<int>(t), v);
    }
  };
  tbb::parallel_for(std::size_t{0}, n_parts, [&](std::size_t part) {
    next[part].assign(n_vertices, 0);
    for_each_corner(part, [&](int, int v) { ++next[part][v]; });
  });
  layer.ring_begin.assign(n_vertices + 1, 0);
  std::vector<int> begin((n_vertices + kVerticesPerBlock - 1) / kVerticesPerBlock + 1, 0);  // of the rings of a block
  const auto for_each_in_block = [&](std::size_t block, const auto& f) {
    for (std::size_t v = block * kVerticesPerBlock; v < std::min(n_vertices, (block + 1) * kVerticesPerBlock); ++v)
      f(v);
  };
  tbb::parallel_for(std::size_t{1}, begin.size(), [&](std::size_t end) {
    for_each_in_block(end - 1, [&](std::size_t v) {
      for (const std::vector<int>& n : next) begin[end] += n[v];
    });
  });
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  tbb::parallel_for(std::size_t{1}, begin.size(), [&](std::size_t end) {
    int sum = begin[end - 1];
    for_each_in_block(end - 1, [&](std::size_t v) {
      for (std::vector<int>& n : next) sum += std::exchange(n[v], sum);
      layer.ring_begin[v + 1] = sum;
    });
  });
  layer.ring = touched<int>(4 * n_tets);
  tbb::parallel_for(std::size_t{0}, n_parts, [&](std::size_t part) {
    for_each_corner(part, [&](int t, int v) { layer.ring[next[part][v]++] = t; });
  });
}

void colour_greedily(ActiveLayer& layer) {
  layer.colour.assign(layer.V.size(), -1);
  std::vector<int> taken_by;  // per colour, the last vertex that found it taken
  for (int v = 0; v < static_cast<int>(layer.V.size()); ++v) {
    if (layer.role[v] == ActiveLayer::Role::Fixed) continue;
    for (int r = layer.ring_begin[v]; r < layer.ring_begin[v + 1]; ++r) {
      for (const int w : layer.C[layer.ring[r]]) {
        const int colour = layer.colour[w];
        if (colour < 0) continue;
        if (colour >= static_cast<int>(taken_by.size())) taken_by.resize(colour + 1, -1);
        taken_by[colour] = v;
      }
    }
    layer.colour[v] = static_cast<int>(std::find_if(taken_by.begin(), taken_by.end(), [&](int w) { return w != v; }) -
                                       taken_by.begin());
  }
}

}  // namespace umtet
