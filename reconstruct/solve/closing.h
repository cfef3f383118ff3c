#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "reconstruct/cloud/neighbour_tree.h"
#include "reconstruct/level_set/level_set.h"
#include "reconstruct/solve/algebraic_spheres.h"
#include "reconstruct/solve/scan_holes.h"

namespace umtet {

/// How psi closes a body where a scan has no samples.
enum class Closing {
  Auto,    ///< each hole as its rim says: smooth where the surface bends together there, else flat
  Smooth,  ///< the surface goes on with the curvature it has along the rim, no farther than a sphere through the rim
  Flat,    ///< along the surface that sees as many samples from inside as from outside
  None,    ///< as the Hessian energy alone has it, to the wall of the box where nothing closes it
};

/// A hole of the scan, model units, and what became of it.
struct FittedHole {
  ScanHole hole;
  enum class How {
    AsFitted,  ///< the Hessian energy alone closes it
    Smooth,
    Flat,
  } how = How::AsFitted;
};

/// What has to be said where no sample is, after a first fit.
///
/// psi is left as it is wherever the functional alone closes it well. It does not where psi < 0 reaches the wall of the
/// box, or goes farther from the flat closing of a hole than ScanHole::bulge() to where hardly any sample has its inner
/// side (by the winding number, a level that depends on the rim as for a ball). There the second fit gets
///
///  - samples of the flat closing, with normals, for holes that are closed flat;
///  - weak values for far cells, around a hole that is closed smoothly the distance to the algebraic spheres of the
///    samples, as far as a sphere through its rim goes, and elsewhere plus or minus the distance to the nearest sample,
///    by the winding number.
///
/// Samples are merged ones of the coarsest lattice, and only that lattice hears of the above: bands follow samples.
class ClosingPlan {
 public:
  /// @param psi  of the first fit, on one lattice
  /// @param samples  of the surface, in the units of that lattice, w_gradient = area / h^2
  ClosingPlan(const LevelSet& psi, std::vector<SsdSample> samples, Closing closing);

  /// False: psi is as it should be, or cannot be mended: it ends at the wall, and the samples are a sheet.
  bool is_needed() const { return is_needed_; }
  /// What a second fit has to cover, model units: the box of the samples, and how far smooth closings may go.
  const Eigen::AlignedBox3d& box() const { return box_; }
  const std::vector<FittedHole>& holes() const { return closed_; }
  /// What a second fit gets beside the samples, in units of its lattice. @pre is_needed()
  std::vector<SsdSample> samples(const Lattice& lattice) const;

 private:
  bool find_holes(const LevelSet& psi);
  bool judge(const std::vector<std::uint8_t>& far, const std::vector<float>& value, const std::vector<float>& w);
  void prepare();
  bool is_flat(int hole) const;
  std::optional<double> value_at(const Vec3& xi, double nearest) const;

  Lattice lattice_;  ///< of the first fit: its units are those of all that follows
  Closing closing_;
  std::vector<SsdSample> surface_;
  ScanHoles found_;
  std::vector<FittedHole> closed_;
  Eigen::AlignedBox3d box_;
  bool is_needed_ = false;
  std::optional<ScaledWindingNumber> winding_;
  std::optional<NeighbourTree> closing_tree_;  ///< of found_.places
  std::optional<AlgebraicSpheres> spheres_;
};

}  // namespace umtet
