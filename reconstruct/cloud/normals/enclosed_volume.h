#pragma once

#include <vector>

#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Volume enclosed by a piece of surface, computed from its samples.
struct EnclosedVolume {
  double volume = 0;    ///< sum a_i (x_i - c).n_i / 3 about its centroid c: > 0 where the normals point outward
  double area = 0;      ///< sum a_i
  double openness = 1;  ///< |sum a_i n_i| / area: 0 for a closed surface, 1 for a flat piece
  double fullness = 0;  ///< |volume| / volume of the sphere with this area: 1 for a sphere, 0 for a sheet
  std::size_t n_points = 0;

  /// True if the sign of the volume distinguishes inside from outside: the piece is sufficiently closed and encloses a
  /// volume. A hemisphere has openness 0.5, a sheet has fullness 0; an ellipsoid of 1 : 1 : 0.02 has fullness 0.05.
  bool tells_sides() const { return openness < 0.3 && fullness > 0.02; }
};

/// Enclosed volume of every component. @param areas  a_i of sample_areas()
std::vector<EnclosedVolume> enclosed_volumes(const OrientedPointCloud& cloud, const std::vector<double>& areas,
                                             const std::vector<std::uint32_t>& component, std::size_t n_components);

/// Winding number of a component around x: 1 inside, 0 outside, by its normals. Sums at most 20000 samples, evenly
/// picked; the result is inaccurate within a few spacings of the component.
double winding_number(const OrientedPointCloud& cloud, const std::vector<double>& areas,
                      const std::vector<std::uint32_t>& members, const Vec3& x);

}  // namespace umtet
