#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "mesh/core/tet_mesh.h"

namespace umtet {

/// Six times the signed volume mu(K); > 0 for a positively oriented tet.
inline double volume6(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).cross(c - a).dot(d - a);
}

/// Sum of the six squared edge lengths.
inline double sum_of_squared_edges(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).squaredNorm() + (c - a).squaredNorm() + (d - a).squaredNorm() + (c - b).squaredNorm() +
         (d - b).squaredNorm() + (d - c).squaredNorm();
}

/// 12 cbrt(9) / 6^(2/3) = 12 cbrt(1/4): the factor of eq. (6) for a volume given by volume6().
inline constexpr double kMeanRatioFactor = 7.559526299369239;

/// Mean ratio Q(K) = 12 cbrt(9) |mu|^(2/3) sign(mu) / sum of squared edge lengths            [Rangarajan2018, eq. (6)]
/// 1 for a regular tet, 0 for a flat one, < 0 for an inverted one.
inline double mean_ratio(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const double root = std::cbrt(volume6(a, b, c, d));
  return kMeanRatioFactor * root * std::abs(root) / sum_of_squared_edges(a, b, c, d);
}

inline double mean_ratio(const TetMesh& mesh, const Tet& t) {
  return mean_ratio(mesh.V[t[0]], mesh.V[t[1]], mesh.V[t[2]], mesh.V[t[3]]);
}

/// Least and greatest of the six dihedral angles, degrees.
struct DihedralRange {
  double min_deg, max_deg;
};
DihedralRange dihedral_range(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Dihedral angle between the faces that share edge (a, b) in tet abcd, degrees.
double dihedral_angle_deg(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

}  // namespace umtet
