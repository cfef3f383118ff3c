#pragma once

#include <cmath>
#include <numbers>

#include "tests/support/box_tets.h"

namespace umtet::testing {

/// The swimmer's channel, 12 x 12 x 29.16 about the origin and open at the upper end, with a sphere of radius 1 at the
/// origin instead of the swimmer: a grid of n cells across, n a multiple of 8, without a block of n / 4 in its middle;
/// what is between that block and one three times as wide is mapped so that the block is the sphere, layers growing
/// with the distance.
struct SphereInChannel {
  TetMesh mesh;
  std::vector<int> fluid, sphere, walls;

  explicit SphereInChannel(int n) {
    const double length = 29.16;
    const int n_z = 2 * int(std::lround(n * length / 24));
    const double flatten = (12. / n) / (length / n_z);  // cells are not quite cubes
    mesh = box_tets({-6, -6, -length / 2}, {6, 6, length / 2}, {n, n, n_z});
    const auto norm = [&](const Vec3& x) { return x.cwiseProduct(Vec3(1, 1, flatten)).cwiseAbs().maxCoeff(); };
    const double block = 1.5, mapped = 4.5;
    fluid = tets_where(mesh, [&](const Vec3& x) { return norm(x) > block; });
    sphere = vertices_where(mesh, [&](const Vec3& x) { return std::abs(norm(x) - block) < 1e-9; });
    walls = vertices_where(mesh, [&](const Vec3& x) {
      return x.head<2>().cwiseAbs().maxCoeff() > 6 - 1e-9 || x.z() < -length / 2 + 1e-9;
    });
    for (Vec3& x : mesh.V) {
      const double s = norm(x), w = (s - block) / (mapped - block);
      if (w > -1e-9 && w < 1) x *= std::pow(x.norm() * mapped / s, w) / x.norm();
    }
  }
};

/// The drag of a sphere of radius a that moves along the axis of a long square duct of half width l, over that without
/// walls: 1 / (1 - 1.903266 a / l), to first order in a / l [HappelBart1974]; `drag_in_duct` finds 1.900.
inline double wall_corrected_drag(double a_over_l) { return 1 / (1 - 1.903266 * a_over_l); }

/// The same on the axis of a circular cylinder of radius R, lambda = a / R up to about .8 [HabermanSayre1958]. Drag in
/// a container is at least that in a larger one (least dissipation).
inline double drag_in_cylinder(double lambda) {
  const double l3 = lambda * lambda * lambda, l5 = l3 * lambda * lambda;
  return (1 - .75857 * l5) / (1 - 2.105 * lambda + 2.0865 * l3 - 1.7068 * l5 + .72603 * l3 * l3);
}

}  // namespace umtet::testing
