#include "reconstruct/triangles/triangle_winding.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "common/formatted.h"
#include "common/polled_loops.h"

namespace umtet {
namespace {

// Numbers of triangles have 32 bits.
constexpr std::size_t kMostSummed = std::size_t{1} << 31;
// Triangles of a leaf, at most: a series costs as much as one of them.
constexpr std::uint32_t kSummedLeaf = 4;
// A node is a series from so many times its radius on: 2 is the choice of [Barill2018].
constexpr double kBeta = 2;

}  // namespace

double solid_angle_share(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 p = a - x, q = b - x, r = c - x;
  const double lp = p.norm(), lq = q.norm(), lr = r.norm();
  const double determinant = p.dot(q.cross(r));
  const double divisor = lp * lq * lr + p.dot(q) * lr + q.dot(r) * lp + r.dot(p) * lq;
  return std::atan2(determinant, divisor) / (2 * std::numbers::pi);
}

TriangleWinding::TriangleWinding(const TriangleMesh& mesh) {
  const std::size_t n = mesh.F.size();
  if (n == 0 || n >= kMostSummed)
    throw std::invalid_argument(formatted("%zu triangles: must be at least one, below 2^31", n));
  triangles_.resize(n);
  for (std::size_t f = 0; f < n; ++f) {
    triangles_[f] = {
        mesh.centroid(f), {mesh.corner(f, 0), mesh.corner(f, 1), mesh.corner(f, 2)}, static_cast<std::uint32_t>(f)};
  }
  nodes_.reserve(n);
  grow_sample_tree(triangles_, nodes_, kSummedLeaf, 0, static_cast<std::uint32_t>(n));
  tbb::parallel_for(std::size_t{0}, nodes_.size(), [&](std::size_t i) { find_moments(nodes_[i]); });
}

void TriangleWinding::find_moments(Node& node) const {
  const auto area_vector = [](const Corners& t) { return Vec3((t.at[1] - t.at[0]).cross(t.at[2] - t.at[0]) / 2); };
  double area = 0;
  Vec3 sum = Vec3::Zero();
  const Vec3& origin = triangles_[node.first].x;
  for (std::uint32_t i = node.first; i < node.last; ++i) {
    const double a = area_vector(triangles_[i]).norm();
    area += a;
    sum += a * (triangles_[i].x - origin);
  }
  node.centre = area > 0 ? Vec3(origin + sum / area) : origin;
  double radius2 = 0;
  for (std::uint32_t i = node.first; i < node.last; ++i) {
    const Corners& t = triangles_[i];
    const Vec3 n = area_vector(t);
    node.dipole += n;
    node.second += (t.x - node.centre) * n.transpose();
    for (const Vec3& corner : t.at) radius2 = std::max(radius2, (corner - node.centre).squaredNorm());
  }
  node.far = kBeta * std::sqrt(radius2);
}

double TriangleWinding::operator()(const Vec3& x) const {
  double near = 0, far = 0;
  std::array<std::uint32_t, kDeepestSampleTree> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t number = stack[--depth];
    const Node& node = nodes_[number];
    const Vec3 r = node.centre - x;
    const double r2 = r.squaredNorm();
    if (r2 > node.far * node.far) {
      const double q2 = 1 / r2, q3 = q2 * std::sqrt(q2);
      far += q3 * (node.dipole.dot(r) + node.second.trace() - 3 * q2 * r.dot(node.second * r));
    } else if (node.right > 0) {
      stack[depth++] = node.right;
      stack[depth++] = number + 1;
    } else {
      for (std::uint32_t i = node.first; i < node.last; ++i) {
        const auto& [a, b, c] = triangles_[i].at;
        near += solid_angle_share(x, a, b, c);
      }
    }
  }
  return near + far / (4 * std::numbers::pi);
}

std::vector<double> TriangleWinding::operator()(const std::vector<Vec3>& places, const Context& context) const {
  std::vector<double> w(places.size());
  polled_parallel_for(places.size(), kValuesPerPoll, context, [&](std::size_t i) { w[i] = (*this)(places[i]); });
  return w;
}

}  // namespace umtet
