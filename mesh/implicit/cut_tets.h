#pragma once

#include <cstdint>
#include <vector>

#include "mesh/core/tet_mesh.h"
#include "mesh/implicit/zero_set.h"

namespace umtet {

/// The tets of any mesh in which psi changes sign, with their vertices. They contain the zero set of the linear
/// interpolant of psi.
struct CutTets {
  std::vector<Vec3> x;
  std::vector<double> psi;                ///< values at x; a value that is not finite counts as outside
  std::vector<std::uint8_t> on_boundary;  ///< whether x is on the boundary of the mesh
  std::vector<Tet> tets;                  ///< indices into x
};

/// Topology of the zero set of the linear interpolant, as by zero_set_topology() on a grid: cut edges, triangles and
/// tets are the vertices, edges and faces of a polygonal surface, always a 2-manifold inside the mesh. `spacing` is the
/// longest cut edge / sqrt(3): the longest edges of a grid of cubes with this spacing are as long.
///
/// Cost: a sort of the edges. The result depends on the order of x, but not on the order of the tets.
/// \throw std::length_error for 2^31 cut edges
ZeroSetTopology zero_set_topology(const CutTets& cut);

}  // namespace umtet
