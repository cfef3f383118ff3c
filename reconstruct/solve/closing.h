#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "reconstruct/cloud/neighbours/neighbour_tree.h"
#include "reconstruct/level_set/level_set.h"
#include "reconstruct/solve/algebraic_spheres.h"
#include "reconstruct/solve/scan_holes.h"

namespace umtet {

/// Closing of a body where a scan has no samples.
enum class Closing {
  /// Decides for each hole by its rim: smooth if the surface curves together there (ScanHole::rim_cosine), else flat.
  Auto,
  Smooth,  ///< continues the surface with the curvature along the rim, no farther than a sphere through the rim
  Flat,    ///< along the surface on which the winding number of the samples is 1/2
  None,    ///< by the Hessian energy alone; the body extends to the wall of the box if nothing closes it
};

/// A hole of the scan, model units, and its closing.
struct FittedHole {
  ScanHole hole;
  enum class How {
    AsFitted,  ///< the Hessian energy alone closes it
    Smooth,
    Flat,
  } how = How::AsFitted;
};

/// Plan for closing a body where there are no samples, made after a first fit.
/// psi is unchanged wherever the functional alone closes it well. A second fit is needed if {psi < 0} reaches the wall
/// of the box, or if it extends farther from the flat closing of a hole than ScanHole::bulge(), to points at which the
/// winding number of the samples is low (the threshold depends on the rim, as for a ball). In these regions the second
/// fit gets
///
///  - samples of the flat closing, with normals, for holes that are closed flat;
///  - weak values for far cells. Around a hole that is closed smoothly they are the distance to the algebraic spheres
///    of the samples, up to a sphere through its rim. Elsewhere they are plus or minus the distance to the nearest
///    sample, by the winding number.
///
/// Samples are the merged ones of the coarsest lattice, and only this lattice uses these additions: bands follow
/// samples.
class ClosingPlan {
 public:
  /// @param psi      result of the first fit, on one lattice
  /// @param samples  samples of the surface, in the units of that lattice, w_gradient = area / h^2
  ClosingPlan(const LevelSet& psi, std::vector<SsdSample> samples, Closing closing);

  /// False if psi needs no second fit, or cannot be repaired: it ends at the wall, and the samples are a sheet.
  bool is_needed() const { return is_needed_; }
  /// Region of a second fit, model units: the box of the samples, extended by the reach of smooth closings.
  const Eigen::AlignedBox3d& box() const { return box_; }
  const std::vector<FittedHole>& holes() const { return closed_; }
  /// Additional samples of a second fit, in units of its lattice. @pre is_needed()
  std::vector<SsdSample> samples(const Lattice& lattice) const;

 private:
  bool find_holes(const LevelSet& psi);
  bool judge(const std::vector<std::uint8_t>& far, const std::vector<float>& value, const std::vector<float>& w);
  void prepare();
  bool is_flat(int hole) const;
  std::optional<double> value_at(const Vec3& xi, double nearest) const;

  Lattice lattice_;  ///< lattice of the first fit; all members below are in its units
  Closing closing_;
  std::vector<SsdSample> surface_;
  ScanHoles found_;
  std::vector<FittedHole> closed_;
  Eigen::AlignedBox3d box_;
  bool is_needed_ = false;
  std::optional<ScaledWindingNumber> winding_;
  std::optional<NeighbourTree> closing_tree_;  ///< tree of found_.places
  std::optional<AlgebraicSpheres> spheres_;
};

}  // namespace umtet
