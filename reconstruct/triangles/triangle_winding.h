#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/context.h"
#include "reconstruct/triangles/triangle_mesh.h"
#include "reconstruct/winding/sample_tree.h"

namespace umtet {

/// Omega / (4 pi) of the triangle abc seen from x: its share of all directions, > 0 where x is on its inner side
/// [VanOosterom1983]. In its plane the sign is that of rounding.
double solid_angle_share(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c);

/// How often triangles wind around a place: the generalised winding number [Jacobson2013]
///
///     w(x) = sum_f Omega_f(x) / (4 pi)
///
/// 1 inside of a closed surface, 0 outside, 2 where two bodies overlap. Where triangles are missing it is what part of
/// all directions meets the rest, so it changes smoothly there, and by one across every triangle.
///
/// Triangles are in a binary tree; a node that is seen from beyond twice its radius is a dipole about its centre of
/// area and the term after it [Barill2018]. w is off by .005 on average.
class TriangleWinding {
 public:
  /// \throw std::invalid_argument  no triangle, or 2^31 and more. Cost: O(n log n)
  explicit TriangleWinding(const TriangleMesh& mesh);

  /// w(x). Cost: O(log n) and the triangles nearby. Thread-safe.
  double operator()(const Vec3& x) const;
  /// At many places, from all threads. Does not depend on their number. \throw Cancelled
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
    double far = 0;              ///< distance from which on the series is used
  };
  std::vector<Corners> triangles_;
  std::vector<Node> nodes_;  ///< parents before children

  void find_moments(Node& node) const;
};

}  // namespace umtet
