#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <span>
#include <vector>

#include "common/context.h"
#include "mesh/core/far_from_zero.h"
#include "mesh/core/implicit_function.h"

namespace umtet {

/// One connected component of {psi = 0} as resolved by the grid.
struct ZeroSetComponent {
  long euler_characteristic = 0;    ///< cut edges - cut triangles + cut tets
  long genus = 0;                   ///< (2 - chi) / 2; meaningful when closed
  bool closed = true;               ///< false: the component reaches the wall of the box
  Vec3 seed = Vec3::Zero();         ///< a point of the component, linear along a grid edge: |psi| = O(spacing^2)
  double area = 0;                  ///< area of the linear interpolant, model units^2: second-order accurate
  Eigen::AlignedBox3d box;          ///< bounding box of its cut points
  std::size_t n_cut_edges = 0;      ///< resolution of the component: a few dozen edges mean that it is barely resolved
  std::size_t first_cut_point = 0;  ///< its n_cut_edges points begin here in ZeroSetTopology::cut_points
};

/// Topology of {psi = 0}: its components and cut points.
struct ZeroSetTopology {
  std::vector<ZeroSetComponent> components;  ///< descending in area
  long euler_characteristic = 0;             ///< sum over components
  double spacing = 0;                        ///< the spacing used, at most the argument `spacing`
  std::size_t n_not_finite = 0;              ///< nodes where psi is not finite; they count as outside
  std::vector<Vec3> cut_points;              ///< zeros of psi on the cut edges (linear), component by component
  std::vector<double> cut_areas;             ///< share of the surface area of each cut point

  std::span<const Vec3> points_of(const ZeroSetComponent& c) const {
    return {cut_points.data() + c.first_cut_point, c.n_cut_edges};
  }
  std::span<const double> areas_of(const ZeroSetComponent& c) const {
    return {cut_areas.data() + c.first_cut_point, c.n_cut_edges};
  }
};

/// Topology of {psi = 0} in a box, counted on a grid that is independent of the mesher.
///
/// Cubes of edge `spacing` (reduced per axis so that they fill the box) are cut into six tets each (Kuhn); psi is
/// sampled at the nodes. A simplex whose nodes differ in sign is cut; cut edges, triangles and tets are the vertices,
/// edges and faces of a polygonal surface, always a 2-manifold inside the box, so chi needs no geometry.
///
/// The result is exact for the zero set of the piecewise linear interpolant. For psi itself it covers only what the
/// grid resolves: a sheet, a gap or a handle thinner than about one spacing can fall between nodes, and then both the
/// number of components and the genus are wrong without any indication. Agreement between two spacings is evidence, not
/// proof; so is agreement with a mesh, whose background is another grid.
///
/// Cost: one value of psi per node (threads over rows of a slab; psi must be thread-safe). Memory: two slabs plus about
/// 70 bytes per cut edge. The result does not depend on the number of threads.
/// @param context  polled every few thousand nodes
/// @param far      known for the distance `spacing`: where it returns true, psi is not evaluated, and the sign of the
///                 previous node is used. The result is the same (except that n_not_finite counts only nodes where psi
///                 was evaluated).
/// \throw std::invalid_argument for an empty or unbounded box, or spacing <= 0
/// \throw std::length_error for more than 1e9 cells along an axis, 2^31 nodes in a slab or 2^31 cut edges
/// \throw Cancelled
ZeroSetTopology zero_set_topology(ImplicitFunctionRef psi, const Eigen::AlignedBox3d& box, double spacing,
                                  const Context& context = {}, const FarFromZero& far = {});

}  // namespace umtet
