#pragma once

#include "body/body.h"
#include "reconstruct/cloud/neighbours/neighbour_tree.h"

namespace umtet {

/// Tells sheets of psi = 0 that samples support from sheets that only close a hole. A closing sheet is a guess, and no
/// reason for short edges: a relief that is closed flat becomes arbitrarily thin along its rim.
class SheetSupport {
 public:
  /// \pre the cloud of the domain has points, and a normal for each point. The domain outlives this object.
  explicit SheetSupport(const Domain& domain);

  /// Returns whether one of the eight samples nearest to x is within support_radius() and has its normal in the
  /// direction in which psi increases. Along the rim of a sheet that was closed flat, samples are near the closing
  /// sheet, but their normals have the opposite direction.
  /// Thread-safe.
  /// @param x         point on psi = 0
  /// @param gradient  gradient of psi at x
  bool operator()(const Vec3& x, const Vec3& gradient) const;

 private:
  const Domain& domain_;
  double radius_;
  NeighbourTree tree_;
};

}  // namespace umtet
