#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "common/vec3.h"
#include "mesh/core/piecewise_domain.h"

namespace umtet {

/// A set of regions: bit k belongs to region k.
using RegionSet = std::uint64_t;
/// Most regions of a domain, which fit into a RegionSet.
inline constexpr int kMostRegions = 64;

/// Space divided into regions 0 .. n - 1 by smooth functions. Region 0 is what surrounds the bodies.
///
/// Two regions meet on a sheet {f_ab = 0}, three on a curve, four or more at a corner. Sheets of one function f are one
/// patch: in a domain of bodies, all sheets on which body k covers lower regions lie on psi_k = 0.
class RegionDomain {
 public:
  /// Region k + 1 is body k = {psi_k < 0} without all later bodies: bodies may be nested, apart, or overlap.
  /// \throw std::invalid_argument for no body or kMostRegions bodies or more
  static RegionDomain of_bodies(std::vector<PatchFunction> bodies);
  /// Region k is where function k is less than all others, as where each function is minus the share of a label.
  /// \throw std::invalid_argument for fewer than two functions or more than kMostRegions
  static RegionDomain of_least(std::vector<PatchFunction> functions);

  /// The domain in coordinates y with x = origin + scale y, component by component. \pre scale > 0
  RegionDomain in_coordinates(const Vec3& origin, const Vec3& scale) const;

  int n_regions() const { return n_regions_; }
  /// The region of a point.
  int region(const Vec3& x) const;
  /// Whether the regions are bodies, the later ones before the earlier ones.
  bool has_bodies() const { return has_bodies_; }
  /// psi_k of body k: region k + 1. \pre has_bodies()
  const PatchFunction& body(int k) const { return functions_[static_cast<std::size_t>(k)]; }
  /// psi of all bodies, or the functions of which the least decides.
  const std::vector<PatchFunction>& functions() const { return functions_; }

  /// The patch of the sheet between two regions. \pre a != b
  int patch(int a, int b) const {
    return patch_of_[static_cast<std::size_t>(a) * static_cast<std::size_t>(n_regions_) + static_cast<std::size_t>(b)];
  }
  /// f_ab: its zero set contains the sheet between two regions, and it is negative in the greater one.
  double sheet(int a, int b, const Vec3& x, Vec3* gradient = nullptr) const {
    return boundary_.patch(patch(a, b), x, gradient);
  }
  /// The patches, whose psi is 0 where two regions meet: the domain of BoundaryStrata.
  const PiecewiseDomain& boundary() const { return boundary_; }

 private:
  RegionDomain(std::vector<PatchFunction> functions, bool has_bodies);

  std::vector<PatchFunction> functions_;
  bool has_bodies_;
  int n_regions_;
  std::vector<int> patch_of_;  ///< per pair of regions
  PiecewiseDomain boundary_;
};

}  // namespace umtet
