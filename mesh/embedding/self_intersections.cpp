#include "mesh/embedding/self_intersections.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/polled_loops.h"
#include "mesh/base/check_indices.h"
#include "mesh/core/orientation.h"
#include "mesh/embedding/triangle_intersection.h"
#include "mesh/embedding/box_tree.h"

namespace umtet {
namespace {

using Pair = std::array<int, 2>;

constexpr std::size_t kLeavesPerPoll = 1 << 12;
// A sum of n terms is off by n eps of their magnitudes at most: below this share of them its sign says nothing.
constexpr double kVolumeRounding = 1e-9;

std::vector<Pair> gathered(const std::vector<std::vector<Pair>>& found) {
  std::vector<Pair> all;
  for (const auto& some : found) all.insert(all.end(), some.begin(), some.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

/// Appends the pairs that meet, one face of leaf k, the other at or behind it in the tree's order.
void pairs_of_leaf(const BoxTree& tree, const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                   std::size_t k, std::vector<Pair>& found) {
  const BoxTree::Range own = tree.leaf(k);
  const auto& box = tree.leaf_box(k);
  const std::vector<int>& order = tree.order();
  tree.for_leaves(
      k, [&](const BoxTree::Box& other) { return other.intersects(box); },
      [&](std::size_t leaf) {
        const BoxTree::Range range = tree.leaf(leaf);
        for (int i = own.begin; i < own.end; ++i) {
          const BoxTree::Box& here = tree.box_at(i);
          for (int j = std::max(range.begin, i + 1); j < range.end; ++j) {
            if (!here.intersects(tree.box_at(j))) continue;
            const int f = std::min(order[i], order[j]), g = std::max(order[i], order[j]);
            if (meet_beyond_shared(V, faces[f], faces[g])) found.push_back({f, g});
          }
        }
      });
}

/// The point beside x, by (0, e, e^2) with e > 0 as small as you like, against the edge a b seen along x: never on it.
int side_of_edge(const Vec3& a, const Vec3& b, const Vec3& x) {
  const int sign = projected_orientation_sign(a, b, x, 0);
  if (sign != 0) return sign;
  if (a.z() != b.z()) return a.z() > b.z() ? 1 : -1;
  return a.y() == b.y() ? 0 : a.y() < b.y() ? 1 : -1;
}

/// How often a ray from beside x towards +x leaves through this face less how often it enters: 1, 0 or -1.
int crossing(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) {
  const int facing = projected_orientation_sign(a, b, c, 0);
  if (facing == 0 || side_of_edge(a, b, x) != facing || side_of_edge(b, c, x) != facing ||
      side_of_edge(c, a, x) != facing) {
    return 0;
  }
  return orientation_sign(a, b, c, x) == -facing ? facing : 0;
}

}  // namespace

std::vector<Pair> self_intersections(const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                                     const Context& context) {
  check_indices(faces, V.size(), "face");
  if (faces.empty()) return {};
  const BoxTree tree(V, faces);
  std::vector<std::vector<Pair>> found(tree.n_leaves());
  polled_parallel_for(tree.n_leaves(), kLeavesPerPoll, context,
                      [&](std::size_t k) { pairs_of_leaf(tree, V, faces, k, found[k]); });
  return gathered(found);
}

void ComponentVolume::add(const Vec3& from, const Vec3& a, const Vec3& b, const Vec3& c) {
  const double six = (a - from).dot((b - from).cross(c - from));
  sum += six;
  magnitude += std::abs(six);
}

int ComponentVolume::sign() const { return std::abs(sum) <= kVolumeRounding * magnitude ? 0 : sum > 0 ? 1 : -1; }

std::vector<int> windings(const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                          const std::vector<int>& component, const std::vector<Vec3>& points, const Context& context) {
  check_indices(faces, V.size(), "face");
  std::vector<int> winding(points.size(), 0);
  if (faces.empty()) return winding;
  const BoxTree tree(V, faces);
  polled_parallel_for(points.size(), kLeavesPerPoll, context, [&](std::size_t c) {
    const Vec3& x = points[c];
    tree.for_leaves(
        0,
        [&](const BoxTree::Box& box) {
          return box.max().x() >= x.x() && box.min().y() <= x.y() && x.y() <= box.max().y() && box.min().z() <= x.z() &&
                 x.z() <= box.max().z();
        },
        [&](std::size_t leaf) {
          for (int k = tree.leaf(leaf).begin; k < tree.leaf(leaf).end; ++k) {
            const int f = tree.order()[k];
            if (component[f] == static_cast<int>(c)) continue;
            winding[c] += crossing(V[faces[f][0]], V[faces[f][1]], V[faces[f][2]], x);
          }
        });
  });
  return winding;
}

bool is_wrongly_nested(const ComponentVolume& volume, int winding) {
  // The other surfaces around the outer side of this one; it adds 0 there if it is the outside of a body, and -1 if
  // it is the wall of a cavity.
  const int sign = volume.sign();
  return sign == 0 || winding != (sign > 0 ? 0 : 1);
}

std::vector<int> wrongly_nested(const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                                const std::vector<int>& component, std::size_t n_components, const Context& context) {
  check_indices(faces, V.size(), "face");
  if (faces.empty()) return {};
  std::vector<int> first(n_components, -1);
  for (std::size_t i = faces.size(); i-- > 0;) first[component[i]] = static_cast<int>(i);
  std::vector<Vec3> corners;
  for (const int i : first) corners.push_back(V[faces[i][0]]);
  std::vector<ComponentVolume> volume(n_components);
  for (std::size_t i = 0; i < faces.size(); ++i)
    volume[component[i]].add(corners[component[i]], V[faces[i][0]], V[faces[i][1]], V[faces[i][2]]);
  const std::vector<int> winding = windings(V, faces, component, corners, context);
  std::vector<int> wrong;
  for (std::size_t c = 0; c < n_components; ++c) {
    if (is_wrongly_nested(volume[c], winding[c])) wrong.push_back(static_cast<int>(c));
  }
  return wrong;
}

}  // namespace umtet
