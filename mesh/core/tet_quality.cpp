#include "mesh/core/tet_quality.h"

#include <algorithm>
#include <numbers>

namespace umtet {

double dihedral_angle_deg(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 edge = b - a;
  const Vec3 n_c = edge.cross(c - a);
  const Vec3 n_d = edge.cross(d - a);
  // |n_c x n_d| = |edge| |det|. The arc cosine would lose half of the digits near 0 and 180 degrees, where slivers are.
  const double sine = edge.norm() * std::abs(n_c.dot(d - a));
  return std::atan2(sine, n_c.dot(n_d)) * (180.0 / std::numbers::pi);
}

DihedralRange dihedral_range(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const double angles[6] = {dihedral_angle_deg(a, b, c, d), dihedral_angle_deg(a, c, d, b),
                            dihedral_angle_deg(a, d, b, c), dihedral_angle_deg(b, c, a, d),
                            dihedral_angle_deg(b, d, c, a), dihedral_angle_deg(c, d, a, b)};
  const auto [lo, hi] = std::minmax_element(std::begin(angles), std::end(angles));
  return {*lo, *hi};
}

}  // namespace umtet
