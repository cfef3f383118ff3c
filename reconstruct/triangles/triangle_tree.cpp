#include "reconstruct/triangles/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/formatted.h"

namespace umtet {
namespace {

// Numbers of triangles have 32 bits.
constexpr std::size_t kMostTriangles = std::size_t{1} << 31;
// Triangles of a leaf, at most: a box costs as much as one of them.
constexpr std::uint32_t kLeaf = 4;

double off_box2(const Vec3& x, const Vec3& low, const Vec3& high) {
  return (low - x).cwiseMax(x - high).cwiseMax(0).squaredNorm();
}

/// Whether the ray meets the box between `from` and `to`.
bool meets(const Vec3& x, const Vec3& d, double from, double to, const Vec3& low, const Vec3& high) {
  for (int a = 0; a < 3; ++a) {
    if (d[a] == 0) {
      if (x[a] < low[a] || x[a] > high[a]) return false;
      continue;
    }
    double s = (low[a] - x[a]) / d[a], t = (high[a] - x[a]) / d[a];
    if (s > t) std::swap(s, t);
    from = std::max(from, s);
    to = std::min(to, t);
    if (from > to) return false;
  }
  return true;
}

/// How far along the ray the triangle is; infinite where the ray misses it [Moeller1997].
double along_ray(const Vec3& x, const Vec3& d, const std::array<Vec3, 3>& t) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const Vec3 e = t[1] - t[0], f = t[2] - t[0], p = d.cross(f);
  const double determinant = e.dot(p);
  if (determinant == 0) return kNone;
  const Vec3 s = x - t[0];
  const double u = s.dot(p) / determinant;
  if (!(u >= 0 && u <= 1)) return kNone;
  const Vec3 q = s.cross(e);
  const double v = d.dot(q) / determinant;
  if (!(v >= 0 && u + v <= 1)) return kNone;
  return f.dot(q) / determinant;
}

}  // namespace

Vec3 closest_on_triangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c, Vec3* weights) {
  const auto at = [&](double of_b, double of_c) {
    if (weights) *weights = {1 - of_b - of_c, of_b, of_c};
  };
  const Vec3 ab = b - a, ac = c - a, ax = x - a;
  const double d1 = ab.dot(ax), d2 = ac.dot(ax);
  at(0, 0);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vec3 bx = x - b;
  const double d3 = ab.dot(bx), d4 = ac.dot(bx);
  at(1, 0);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    at(d1 / (d1 - d3), 0);
    return a + d1 / (d1 - d3) * ab;
  }
  const Vec3 cx = x - c;
  const double d5 = ab.dot(cx), d6 = ac.dot(cx);
  at(0, 1);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    at(0, d2 / (d2 - d6));
    return a + d2 / (d2 - d6) * ac;
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    if (weights) *weights = {0, 1 - t, t};
    return b + t * (c - b);
  }
  const double whole = va + vb + vc;
  at(vb / whole, vc / whole);
  return a + vb / whole * ab + vc / whole * ac;
}

TriangleTree::TriangleTree(const TriangleMesh& mesh) {
  const std::size_t n = mesh.F.size();
  if (n == 0 || n >= kMostTriangles)
    throw std::invalid_argument(formatted("%zu triangles: must be at least one, below 2^31", n));
  triangles_.resize(n);
  for (std::size_t f = 0; f < n; ++f) {
    triangles_[f] = {
        mesh.centroid(f), {mesh.corner(f, 0), mesh.corner(f, 1), mesh.corner(f, 2)}, static_cast<std::uint32_t>(f)};
  }
  nodes_.reserve(n);
  grow_sample_tree(triangles_, nodes_, kLeaf, 0, static_cast<std::uint32_t>(n));
  for (std::size_t k = nodes_.size(); k-- > 0;) {
    Node& node = nodes_[k];
    if (node.right > 0) {
      const Node &left = nodes_[k + 1], &right = nodes_[node.right];
      node.low = left.low.cwiseMin(right.low);
      node.high = left.high.cwiseMax(right.high);
      continue;
    }
    node.low = node.high = triangles_[node.first].x;
    for (std::uint32_t i = node.first; i < node.last; ++i)
      for (const Vec3& x : triangles_[i].at) {
        node.low = node.low.cwiseMin(x);
        node.high = node.high.cwiseMax(x);
      }
  }
}

std::optional<TriangleHit> TriangleTree::first_on_ray(const Vec3& x, const Vec3& d, double from, double to,
                                                      const Counts& counts) const {
  TriangleHit hit;
  std::array<std::uint32_t, kDeepestSampleTree> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t number = stack[--depth];
    const Node& node = nodes_[number];
    if (!meets(x, d, from, std::min(to, hit.distance), node.low, node.high)) continue;
    if (node.right > 0) {
      stack[depth++] = node.right;
      stack[depth++] = number + 1;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.last; ++i) {
      const double at = along_ray(x, d, triangles_[i].at);
      const bool is_first =
          at < hit.distance || (at == hit.distance && triangles_[i].number < hit.face);  // whatever the tree
      if (at > from && at <= to && is_first && counts(triangles_[i].number))
        hit = {triangles_[i].number, at, x + at * d};
    }
  }
  return hit.distance < std::numeric_limits<double>::infinity() ? std::optional(hit) : std::nullopt;
}

std::optional<TriangleHit> TriangleTree::nearest(const Vec3& x, double within, const Counts& counts) const {
  return nearest_of(x, within, [&](std::uint32_t face) { return counts(face); });
}

template <class F>
std::optional<TriangleHit> TriangleTree::nearest_of(const Vec3& x, double within, const F& counts) const {
  TriangleHit hit;
  double least2 = within * within;
  bool found = false;
  struct Waiting {
    std::uint32_t node;
    double off2;
  };
  std::array<Waiting, kDeepestSampleTree> stack;
  std::size_t depth = 0;
  stack[depth++] = {0, off_box2(x, nodes_[0].low, nodes_[0].high)};
  while (depth > 0) {
    Waiting next = stack[--depth];
    if (next.off2 > least2) continue;
    while (nodes_[next.node].right > 0) {
      const std::uint32_t l = next.node + 1, r = nodes_[next.node].right;
      Waiting left{l, off_box2(x, nodes_[l].low, nodes_[l].high)}, right{r, off_box2(x, nodes_[r].low, nodes_[r].high)};
      if (right.off2 < left.off2) std::swap(left, right);
      if (!(right.off2 > least2)) stack[depth++] = right;
      next = left;
    }
    if (next.off2 > least2) continue;
    const Node& node = nodes_[next.node];
    for (std::uint32_t i = node.first; i < node.last; ++i) {
      const auto& [a, b, c] = triangles_[i].at;
      const Vec3 y = closest_on_triangle(x, a, b, c);
      const double d2 = (y - x).squaredNorm();
      const bool is_nearer = d2 < least2 || (found && d2 == least2 && triangles_[i].number < hit.face);
      if (!is_nearer || !counts(triangles_[i].number)) continue;
      least2 = d2;
      found = true;
      hit = {triangles_[i].number, 0, y};
    }
  }
  if (!found) return std::nullopt;
  hit.distance = std::sqrt(least2);
  return hit;
}

TriangleHit TriangleTree::nearest(const Vec3& x) const {
  return *nearest_of(x, std::numeric_limits<double>::infinity(), [](std::uint32_t) { return true; });
}

}  // namespace umtet
