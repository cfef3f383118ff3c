#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/solve/ssd_sample.h"
#include "reconstruct/winding/fast_winding_number.h"

namespace umtet {

/// A place is far from the samples from this many cells of the coarsest lattice on: nearer, psi is theirs.
inline constexpr double kFarCells = 3;

/// Nodes of a lattice that no place is near, one flag a node, x fastest.
/// @param places  lattice units
std::vector<std::uint8_t> far_nodes(const Eigen::Vector3i& nodes, const std::vector<Eigen::Vector3d>& places);

/// A part of the surface of a body that its scan does not show. Lattice units where scan_holes() finds it.
struct ScanHole {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of the surface that closes it flat, without its border
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< mean one of that surface, outward, unit
  double area = 0;                                   ///< of that surface but for kFarCells cells along the rim
  double depth = 0;       ///< how far that surface is from samples at most: half the width of the hole
  double rim_cosine = 0;  ///< mean cosine of the samples' normals along the rim with that surface's: 1 in a plane, 0 at
                          ///< the end of a tube

  /// How far from flat a circle or sphere closes it that leaves the rim in the direction of the surface there:
  /// depth sqrt((1 - c) / (1 + c)), which is exact for a ball and for a tube that are cut by a plane.
  double bulge() const;
};

/// Holes, and points of the surface that closes them flat, each with the hole that it belongs to.
struct ScanHoles {
  std::vector<ScanHole> holes;
  std::vector<Eigen::Vector3d> places, normals;  ///< normals: outward, unit
  std::vector<double> areas;
  std::vector<int> hole_of;  ///< of each place
};

/// The winding number of samples in lattice units, scaled so that it jumps by one across their surface: areas behind
/// samples, as neighbours tell them, are some per cent off, and more where the samples are noisy.
class ScaledWindingNumber {
 public:
  /// @param samples  of the surface, w_gradient = area / h^2
  explicit ScaledWindingNumber(const std::vector<SsdSample>& samples);
  double operator()(const Eigen::Vector3d& xi) const { return number_(xi) / scale_; }
  /// Outward, unit; zero where it does not change.
  Eigen::Vector3d outward(const Eigen::Vector3d& xi) const;
  /// What w is on the inner side of the samples, median: 1 of a closed surface, 1/2 of a sheet.
  double inner() const { return inner_; }
  double scale() const { return scale_; }

 private:
  FastWindingNumber number_;
  double scale_ = 1, inner_ = 1;
};

/// Where w = 1/2 is far from the samples, it closes a hole: exactly flat if the rim is plane, since a flat piece covers
/// no part of the directions that are seen from its own plane, and half of them are seen on the closed surface.
/// @param w  at the nodes that are far
/// @param far  of far_nodes()
/// The result does not depend on the number of threads.
ScanHoles scan_holes(const std::vector<SsdSample>& samples, const ScaledWindingNumber& number,
                     const Eigen::Vector3i& nodes, const std::vector<std::uint8_t>& far, const std::vector<float>& w);

}  // namespace umtet
