#include "reconstruct/solve/algebraic_spheres.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "common/formatted.h"

namespace umtet {
namespace {

// Sums of a node cost about as much as those of eight samples.
constexpr std::uint32_t kLeaf = 8;
// A node is taken as one from this many of its radii on [Barill2018].
constexpr double kBeta = 2;

template <class Sums>
void add(Sums& to, double weight, const Sums& more) {
  to.a += weight * more.a;
  to.xn += weight * more.xn;
  to.xx += weight * more.xx;
  to.x += weight * more.x;
  to.n += weight * more.n;
}

}  // namespace

AlgebraicSpheres::AlgebraicSpheres(const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
                                   const std::vector<double>& areas) {
  const std::size_t n = points.size();
  if (n == 0 || normals.size() != n || areas.size() != n)
    throw std::invalid_argument(formatted("%zu points, %zu normals, %zu areas: must be as many, at least one", n,
                                          normals.size(), areas.size()));
  samples_.reserve(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    const Vec3 &x = points[i], &m = normals[i];
    const double a = areas[i];
    samples_.push_back({x, {a, a * x.dot(m), a * x.squaredNorm(), a * x, a * m}, i});
  }
  nodes_.reserve(n / 2 + 1);
  grow_sample_tree(samples_, nodes_, kLeaf, 0, static_cast<std::uint32_t>(n));
  for (Node& node : nodes_) {
    for (std::uint32_t i = node.first; i < node.last; ++i) add(node.sums, 1, samples_[i].sums);
    node.centre = node.sums.a > 0 ? Vec3(node.sums.x / node.sums.a) : samples_[node.first].x;
    double radius2 = 0;
    for (std::uint32_t i = node.first; i < node.last; ++i)
      radius2 = std::max(radius2, (samples_[i].x - node.centre).squaredNorm());
    node.far2 = kBeta * kBeta * radius2;
  }
}

double AlgebraicSpheres::signed_distance(const Vec3& x) const {
  Sums sum;
  std::array<std::uint32_t, kDeepestSampleTree> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t number = stack[--depth];
    const Node& node = nodes_[number];
    const double r2 = (node.centre - x).squaredNorm();
    if (r2 > node.far2) {
      add(sum, 1 / (r2 * r2 * r2), node.sums);
    } else if (node.right > 0) {
      stack[depth++] = node.right;
      stack[depth++] = number + 1;
    } else {
      for (std::uint32_t i = node.first; i < node.last; ++i) {
        const double d2 = (samples_[i].x - x).squaredNorm();
        if (d2 > 0) add(sum, 1 / (d2 * d2 * d2), samples_[i].sums);
      }
    }
  }
  // About x: moments of y = x_i - x.
  const Vec3 mean = sum.x / sum.a, y = mean - x, n = sum.n / sum.a;
  const double yn = sum.xn / sum.a - x.dot(n), yy = sum.xx / sum.a - 2 * x.dot(mean) + x.squaredNorm();
  const double spread = yy - y.squaredNorm();
  const double q = spread > 0 ? (yn - y.dot(n)) / (2 * spread) : 0;
  const Vec3 l = n - 2 * q * y;
  const double c = -l.dot(y) - q * yy;
  // |grad u| is |l| at x and s on the sphere.
  const double s2 = l.squaredNorm() - 4 * c * q;
  const double slope = l.norm() + (s2 > 0 ? std::sqrt(s2) : l.norm());
  return slope > 0 ? 2 * c / slope : 0;
}

}  // namespace umtet
