#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/context.h"
#include "reconstruct/triangles/triangle_mesh.h"
#include "reconstruct/winding/sample_tree.h"

namespace umtet {

/// Solid angle fraction Omega / (4 pi) of the triangle abc seen from x, > 0 if x is on its inner side
/// [VanOosterom1983]. In the plane of the triangle the sign is determined by rounding.
double solid_angle_share(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c);

/// Generalised winding number of triangles [Jacobson2013]
///
///     w(x) = sum_f Omega_f(x) / (4 pi)
///
/// It is 1 inside of a closed surface, 0 outside, and 2 where two bodies overlap. Where triangles are missing it is the
/// fraction of all directions that meet the others, so it varies smoothly there, and jumps by one across every
/// triangle.
///
/// Triangles are stored in a binary tree. Beyond twice its radius, a node is evaluated as a dipole about its centre of
/// area and the next term [Barill2018]. w is off by .005 on average.
class TriangleWinding {
 public:
  /// \throw std::invalid_argument for no triangles, or 2^31 and more. Cost: O(n log n)
  explicit TriangleWinding(const TriangleMesh& mesh);

  /// w(x). Cost: O(log n), plus the triangles nearby. Thread-safe.
  double operator()(const Vec3& x) const;
  /// w at many positions, by all threads. The result does not depend on their number. \throw Cancelled
  std::vector<double> operator()(const std::vector<Vec3>& places, const Context& context = {}) const;

 private:
  struct Corners {
    Vec3 x;  ///< centroid
    std::array<Vec3, 3> at;
    std::uint32_t number;
  };
  struct Node : SampleTreeNode {
    Vec3 centre = Vec3::Zero(), dipole = Vec3::Zero();
    Mat3 second = Mat3::Zero();  ///< sum of (centroid - centre) (area normal)^T
    double far = 0;              ///< distance beyond which the series is used
  };
  std::vector<Corners> triangles_;
  std::vector<Node> nodes_;  ///< parents before children

  void find_moments(Node& node) const;
};

}  // namespace umtet
