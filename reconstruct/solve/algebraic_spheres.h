#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/cloud/point_cloud.h"
#include "reconstruct/winding/sample_tree.h"

namespace umtet {

/// Algebraic point set surface [GuennebaudGross2007]: signed distance to the surface of all samples. At each position
/// x, the sphere
///
///     u(y) = u_c + u_l . y + u_q |y|^2
///
/// is fitted to samples and normals by least squares of grad u(x_i) - n_i, then of u(x_i), with weights a_i / |x_i -
/// x|^6; the result is its distance from x. For a surface at distance d, samples three times farther then have a
/// hundredth of the weight. A smaller exponent would draw more of a tube's rim to the rest of the body, a larger one
/// leaves no curvature. Spheres and planes are reproduced exactly, however small their sampled part is: near a hole the
/// surface continues with the curvature along the rim.
///
/// Samples are stored in a binary tree. Beyond twice its radius, a node has the weight of its centre. This changes
/// weights, not sums, so spheres are still exact.
class AlgebraicSpheres {
 public:
  /// @param normals  outward; those of merged samples may be shorter than one
  /// \throw std::invalid_argument for no points, or a different number of normals or areas
  /// Cost: O(n log n)
  AlgebraicSpheres(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const std::vector<double>& areas);

  /// Signed distance: negative inside, positive outside. x must not be a sample. Cost: O(log n). Thread-safe.
  double signed_distance(const Vec3& x) const;

 private:
  struct Sums {
    double a = 0, xn = 0, xx = 0;             ///< sums of a, a x.n, a x.x
    Vec3 x = Vec3::Zero(), n = Vec3::Zero();  ///< sums of a x, a n
  };
  struct Node : SampleTreeNode {
    double far2 = 0;  ///< squared distance of its centre beyond which it counts as one term
    Vec3 centre = Vec3::Zero();
    Sums sums;
  };
  struct Sample {
    Vec3 x;
    Sums sums;
    std::uint32_t number;  ///< index in the order of the caller
  };

  std::vector<Sample> samples_;
  std::vector<Node> nodes_;
};

}  // namespace umtet
