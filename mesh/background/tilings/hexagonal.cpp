#include <array>
#include <cmath>
#include <vector>

#include "mesh/background/tiling.h"
#include "mesh/background/tilings/periodic_tiling.h"

// Tilings in layers over a plane of equilateral triangles of side 4: vertices (V), midpoints of the edges (E) and
// centroids (C) of the triangles at different heights. Coordinates here are (x, sqrt(3) y, z), in which all points are
// multiples of 1/2 and a turn by 60 degrees is exact. Both have that turn about the z axis, the mirror y -> -y, and a
// mirror between layers; one tet of each orbit is given. Verified by tests/mesh/background/tiling_test.cpp.

namespace umtet {
namespace {

using ExactTet = std::array<Vec3, 4>;

constexpr double kMirrorOfZ = 2;     // z -> 2 - z
constexpr double kMirrorOfSlab = 9;  // z -> 9 - z

// "Z" (Zr4Al3), a tetrahedrally close-packed structure [Sullivan1998; Eppstein2004]: V at heights 4 k and 4 k + 2, E at
// 4 k - 1, C at 4 k + 1 [Rangarajan2018, Fig. 11], with their periodic Delaunay tets.
const std::array<ExactTet, 5>& z_orbits() {
  static const std::array<ExactTet, 5> orbits = {{
      {{{-2, 0, -1}, {-1, -3, -1}, {0, 0, -2}, {0, 0, 0}}},
      {{{-2, -2, 1}, {-2, 2, 1}, {0, 0, 2}, {0, 0, 0}}},
      {{{-2, -2, 1}, {-2, 0, -1}, {0, 0, 0}, {-1, -3, -1}}},
      {{{-2, -2, 1}, {-2, 0, -1}, {-2, 2, 1}, {0, 0, 0}}},
      {{{1, 3, -1}, {2, 0, -1}, {3, 3, -1}, {2, 2, 1}}},
  }};
  return orbits;
}

// An acute slab between flat walls z = 0 and z = 9: layers V 0, C 2.5, V 3.5, E 4.5, V 5.5, C 6.5, V 9. The layers of
// Z, the outermost V moved to 2.5 from its C, where it is the wall. This project's own: an acute slab is also built in
// [Eppstein2004], and it is another one. Copies stack because a wall is a plane of V's triangles.
const std::array<ExactTet, 7>& slab_orbits() {
  static const std::array<ExactTet, 7> orbits = {{
      {{{-4, 0, 0}, {-2, -6, 0}, {0, 0, 0}, {-2, -2, 2.5}}},
      {{{-4, 0, 0}, {-2, -2, 2.5}, {0, 0, 0}, {-2, 2, 2.5}}},
      {{{-2, -2, 2.5}, {-2, 2, 2.5}, {0, 0, 3.5}, {0, 0, 0}}},
      {{{-2, -2, 2.5}, {-2, 0, 4.5}, {0, 0, 3.5}, {-2, 2, 2.5}}},
      {{{-2, -2, 2.5}, {-2, 0, 4.5}, {-1, -3, 4.5}, {0, 0, 3.5}}},
      {{{1, 3, 4.5}, {2, 0, 4.5}, {2, 2, 2.5}, {3, 3, 4.5}}},
      {{{-2, 0, 4.5}, {-1, -3, 4.5}, {0, 0, 3.5}, {0, 0, 5.5}}},
  }};
  return orbits;
}

/// The images of the tets under turns, mirrors and the translations of the triangles into a cell of this many sides
/// along x.
template <class Orbits>
std::vector<ExactTet> images(const Orbits& orbits, double mirror, int n_sides) {
  std::vector<ExactTet> all;
  for (ExactTet tet : orbits) {
    for (int image = 0; image < 24; ++image) {
      for (Vec3& p : tet) {
        if (image % 6 == 0) p.y() = -p.y();
        if (image % 12 == 0) p.z() = mirror - p.z();
        p = {(p.x() - p.y()) / 2, (3 * p.x() + p.y()) / 2, p.z()};
      }
      for (int i = 0; i < n_sides; ++i) {
        for (const Vec3& row : {Vec3(0, 0, 0), Vec3(2, 6, 0)}) {
          ExactTet moved = tet;
          for (Vec3& p : moved) p += row + Vec3(4 * i, 0, 0);
          all.push_back(moved);
        }
      }
    }
  }
  return all;
}

const Vec3& hexagonal_unit() {
  static const Vec3 unit(1, 1 / std::sqrt(3.), 1);
  return unit;
}

}  // namespace

const Tiling& z_phase() {
  static const Tiling tiling =
      periodic_tiling("z", images(z_orbits(), kMirrorOfZ, 1), Vec3(4, 12, 4), hexagonal_unit());
  return tiling;
}

const Tiling& acute_slab() {
  // Two triangles wide, or a vertex of the wall would be its own neighbour a period away.
  static const Tiling tiling =
      periodic_tiling("slab", images(slab_orbits(), kMirrorOfSlab, 2), Vec3(8, 12, 9), hexagonal_unit());
  return tiling;
}

}  // namespace umtet
