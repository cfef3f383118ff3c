#include "body/fidelity/mesh_edge.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <utility>

namespace umtet {
namespace {

constexpr std::size_t kPointsPerTask = 1 << 10;  // a microsecond each

}  // namespace

MeshEdge::MeshEdge(double nominal, const std::vector<Vec3>& vertices, std::vector<double> h)
    : nominal_(nominal), least_(0), tree_(std::make_shared<const NeighbourTree>(vertices)), of_vertex_(std::move(h)) {
  least_ = *std::min_element(of_vertex_.begin(), of_vertex_.end());
}

double MeshEdge::at(const Vec3& x) const {
  if (is_uniform()) return least_;
  Neighbour nearest;
  tree_->k_nearest(x, {&nearest, 1});
  return of_vertex_[nearest.point];
}

std::vector<double> MeshEdge::at(const std::vector<Vec3>& points) const {
  if (is_uniform()) return std::vector<double>(points.size(), least_);
  std::vector<double> h(points.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), kPointsPerTask), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) h[i] = at(points[i]);
  });
  return h;
}

}  // namespace umtet
