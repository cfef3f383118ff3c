#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/cloud/point_cloud.h"
#include "reconstruct/winding/sample_tree.h"

namespace umtet {

/// The signed distance to the algebraic point set surface of all samples [GuennebaudGross2007]: at each place the
/// sphere
///
///     u(y) = u_c + u_l . y + u_q |y|^2
///
/// is fitted to samples and normals by least squares of grad u(x_i) - n_i, then of u(x_i), with weights a_i / |x_i -
/// x|^6; its distance from x is what is asked for. Of a surface that is d away, what is three times farther then has a
/// hundredth of the weight: more of a tube's rim would be drawn to the rest of the body, less leaves no curvature.
/// Spheres and planes come out exactly, however little of them is sampled: near a hole the surface goes on with the
/// curvature that it has along the rim.
///
/// Samples are in a binary tree; one of its nodes, seen from twice its radius on, has the weight of its centre. That
/// changes weights, not sums, so spheres are exact all the same.
class AlgebraicSpheres {
 public:
  /// @param normals  outward; those of merged samples may be shorter than one
  /// \throw std::invalid_argument  no points, or other numbers of normals or areas
  /// Cost: O(n log n)
  AlgebraicSpheres(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const std::vector<double>& areas);

  /// Negative inside, positive outside; x is no sample. Cost: O(log n). Thread-safe.
  double signed_distance(const Vec3& x) const;

 private:
  struct Sums {
    double a = 0, xn = 0, xx = 0;             ///< sums of a, a x.n, a x.x
    Vec3 x = Vec3::Zero(), n = Vec3::Zero();  ///< of a x, a n
  };
  struct Node : SampleTreeNode {
    double far2 = 0;  ///< squared distance of its centre from which on it counts as one
    Vec3 centre = Vec3::Zero();
    Sums sums;
  };
  struct Sample {
    Vec3 x;
    Sums sums;
    std::uint32_t number;  ///< in the order of the caller
  };

  std::vector<Sample> samples_;
  std::vector<Node> nodes_;
};

}  // namespace umtet
