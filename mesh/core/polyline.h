#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "common/vec3.h"

namespace umtet {

/// A polyline with its arc length. Immutable; thread-safe.
class Polyline {
 public:
  Polyline() = default;
  /// \pre at least two points, and consecutive ones differ
  explicit Polyline(std::vector<Vec3> points);

  /// The nearest point of the polyline.
  struct Nearest {
    double distance = 0, arc = 0;
    Vec3 point = Vec3::Zero();
    Vec3 tangent = Vec3::Zero();  ///< unit vector along its segment
  };
  /// Cost: linear in the segments near x, and in a sixteenth of the others.
  Nearest nearest(const Vec3& x) const;
  /// The point at this arc length.
  Vec3 at(double arc) const;

  const std::vector<Vec3>& points() const { return points_; }
  const std::vector<double>& arc() const { return arc_; }  ///< at the points, from 0
  double length() const { return arc_.back(); }

 private:
  std::vector<Vec3> points_;
  std::vector<double> arc_;
  std::vector<Eigen::AlignedBox3d> boxes_;  ///< boxes of consecutive segments
};

}  // namespace umtet
