#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/solve/ssd_sample.h"
#include "reconstruct/winding/fast_winding_number.h"

namespace umtet {

/// A position is far from the samples at this number of cells of the coarsest lattice and beyond; closer, the samples
/// determine psi.
inline constexpr double kFarCells = 3;

/// Flags the nodes of a lattice without a sample near them, one flag per node, x fastest.
/// @param places  sample positions in lattice units
std::vector<std::uint8_t> far_nodes(const Eigen::Vector3i& nodes, const std::vector<Eigen::Vector3d>& places);

/// A hole of a scan: a part of a body's surface without samples. scan_holes() returns lattice units.
struct ScanHole {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< centre of the surface that closes it flat, without its border
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< mean outward normal of that surface, unit
  double area = 0;                                   ///< area of that surface except for kFarCells cells along the rim
  double depth = 0;       ///< maximum distance of that surface from samples: half the width of the hole
  double rim_cosine = 0;  ///< mean cosine between the samples' normals along the rim and that surface's: 1 in a plane,
                          ///< 0 at the end of a tube

  /// Distance from the flat closing of a circle or sphere that leaves the rim in the direction of the surface there:
  /// depth sqrt((1 - c) / (1 + c)). It is exact for a ball and for a tube cut by a plane.
  double bulge() const;
};

/// Holes, and points of the surfaces that close them flat, with the hole of each point.
struct ScanHoles {
  std::vector<ScanHole> holes;
  std::vector<Eigen::Vector3d> places, normals;  ///< normals: outward, unit
  std::vector<double> areas;
  std::vector<int> hole_of;  ///< hole of each point
};

/// Winding number of samples in lattice units, scaled so that it jumps by one across their surface. Sample areas
/// computed from neighbours have errors of some per cent, and more if the samples are noisy.
class ScaledWindingNumber {
 public:
  /// @param samples  samples of the surface, w_gradient = area / h^2
  explicit ScaledWindingNumber(const std::vector<SsdSample>& samples);
  double operator()(const Eigen::Vector3d& xi) const { return number_(xi) / scale_; }
  /// Outward unit normal; zero where the winding number is constant.
  Eigen::Vector3d outward(const Eigen::Vector3d& xi) const;
  /// Median of w on the inner side of the samples: 1 for a closed surface, 1/2 for a sheet.
  double inner() const { return inner_; }
  double scale() const { return scale_; }

 private:
  FastWindingNumber number_;
  double scale_ = 1, inner_ = 1;
};

/// Finds the holes of a scan: far from the samples, the surface w = 1/2 closes a hole. It is exactly flat if the rim is
/// plane, because a flat piece covers none of the directions seen from its own plane, and half of the directions are
/// seen on the closed surface.
/// @param w    winding number at the far nodes
/// @param far  result of far_nodes()
/// The result does not depend on the number of threads.
ScanHoles scan_holes(const std::vector<SsdSample>& samples, const ScaledWindingNumber& number,
                     const Eigen::Vector3i& nodes, const std::vector<std::uint8_t>& far, const std::vector<float>& w);

}  // namespace umtet
