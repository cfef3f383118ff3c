#include "mesh/embedding/box_tree.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_invoke.h>

#include <algorithm>
#include <numeric>

namespace umtet {
namespace {

// Pairs within a leaf are looked at one by one: more triangles in it cost pairs, fewer cost nodes.
constexpr std::size_t kMostInLeaf = 8;
constexpr int kWorthThreads = 1 << 13;

}  // namespace

BoxTree::BoxTree(const std::vector<Vec3>& V, const std::vector<Triangle>& faces)
    : V_(V), faces_(faces), order_(faces.size()), triangle_boxes_(faces.size()) {
  std::size_t n_leaves = 1;
  while (n_leaves * kMostInLeaf < faces.size()) n_leaves *= 2;
  first_leaf_ = n_leaves - 1;
  leaves_.resize(n_leaves);
  boxes_.resize(2 * n_leaves - 1);
  std::iota(order_.begin(), order_.end(), 0);
  std::vector<Vec3> centroid(faces.size());
  tbb::parallel_for(std::size_t{0}, faces.size(),
                    [&](std::size_t i) { centroid[i] = V[faces[i][0]] + V[faces[i][1]] + V[faces[i][2]]; });
  split(0, 0, static_cast<int>(faces.size()), centroid);
}

void BoxTree::split(std::size_t node, int begin, int end, std::vector<Vec3>& centroid) {
  Box& box = boxes_[node];
  if (node >= first_leaf_) {
    leaves_[node - first_leaf_] = {begin, end};
    std::sort(order_.begin() + begin, order_.begin() + end);
    for (int k = begin; k < end; ++k) {
      Box& own = triangle_boxes_[k];
      for (const int v : faces_[order_[k]]) own.extend(V_[v]);
      box.extend(own);
    }
    return;
  }
  Box centres;
  for (int k = begin; k < end; ++k) centres.extend(centroid[order_[k]]);
  int axis = 0;
  if (begin < end) centres.sizes().maxCoeff(&axis);
  const int middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, [&](int a, int b) {
    const double x = centroid[a][axis], y = centroid[b][axis];
    return x != y ? x < y : a < b;
  });
  const auto left = [&] { split(2 * node + 1, begin, middle, centroid); };
  const auto right = [&] { split(2 * node + 2, middle, end, centroid); };
  if (end - begin > kWorthThreads) {
    tbb::parallel_invoke(left, right);
  } else {
    left();
    right();
  }
  box = boxes_[2 * node + 1].merged(boxes_[2 * node + 2]);
}

}  // namespace umtet
