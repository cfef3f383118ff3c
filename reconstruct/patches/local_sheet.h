#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "common/vec3.h"

namespace umtet {

/// Samples to which sheets are fitted.
struct SheetSamples {
  const std::vector<Vec3>& points;   ///< in sample spacings
  const std::vector<Vec3>& normals;  ///< unit, as measured
  double noise;                      ///< standard deviation of positions along the normal, in sample spacings; > 0
  double tilt;  ///< standard deviation of normals about each tangent, radians; > 0. Infinite: normals are not used
};

/// A local sheet: the surface of one patch near a point, as a graph of degree two over a plane,
///
///     z = c_0 + c_1 x + c_2 y + c_3 x^2 + c_4 x y + c_5 y^2,
///
/// fitted to positions, each weighted by 1 / noise^2, and to slopes that normals define, weighted by 1 / tilt^2.
class LocalSheet {
 public:
  /// Fits a sheet, then once more with smaller weights for members that are far from it.
  /// @param origin  where the sheet is expanded
  /// @param up      unit normal of the plane, near the mean normal of the samples
  /// @param members samples on the patch, near the origin
  LocalSheet(const SheetSamples& samples, const Vec3& origin, const Vec3& up, std::span<const std::uint32_t> members);

  /// Signed distance of x from the sheet to first order, > 0 on the side of the normal.
  double distance(const Vec3& x) const;
  /// Unit normal of the sheet below or above x.
  Vec3 normal(const Vec3& x) const;
  /// Median distance of the members from the first fit.
  double residual() const { return residual_; }

 private:
  void fit(const SheetSamples& samples, std::span<const std::uint32_t> members, double outlying);

  Vec3 origin_, u_, v_, w_;
  double residual_ = 0;
  Eigen::Matrix<double, 6, 1> c_;
};

}  // namespace umtet
