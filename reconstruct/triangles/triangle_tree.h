#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "reconstruct/triangles/triangle_mesh.h"
#include "reconstruct/winding/sample_tree.h"

namespace umtet {

/// Closest point of the triangle abc to x [Ericson2005].
/// @param weights  receives the barycentric coordinates of the point, exactly zero on a side; may be null
Vec3 closest_on_triangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c, Vec3* weights = nullptr);

/// Triangle found by a query.
struct TriangleHit {
  std::uint32_t face = 0;
  double distance = std::numeric_limits<double>::infinity();  ///< from the query position, model units
  Vec3 point = Vec3::Zero();
};

/// Bounding volume tree for ray casting and nearest-triangle queries. Keeps its own copy of the triangles. Immutable;
/// queries are thread-safe.
class TriangleTree {
 public:
  /// \throw std::invalid_argument for no triangles, or 2^31 and more. Cost: O(n log n)
  explicit TriangleTree(const TriangleMesh& mesh);

  /// Predicate that selects triangles.
  using Counts = std::function<bool(std::uint32_t face)>;

  /// The first selected triangle on the ray from x along the unit vector d, farther than `from` and up to `to`.
  std::optional<TriangleHit> first_on_ray(const Vec3& x, const Vec3& d, double from, double to,
                                          const Counts& counts) const;
  /// The nearest triangle of all.
  TriangleHit nearest(const Vec3& x) const;
  /// The nearest selected triangle within the distance `within`.
  std::optional<TriangleHit> nearest(const Vec3& x, double within, const Counts& counts) const;

 private:
  struct Corners {
    Vec3 x;  ///< centroid
    std::array<Vec3, 3> at;
    std::uint32_t number;
  };
  struct Node : SampleTreeNode {
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  };
  template <class F>
  std::optional<TriangleHit> nearest_of(const Vec3& x, double within, const F& counts) const;

  std::vector<Corners> triangles_;
  std::vector<Node> nodes_;  ///< parents before children
};

}  // namespace umtet
