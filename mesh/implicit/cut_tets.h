#pragma once

#include <cstdint>
#include <vector>

#include "mesh/core/tet_mesh.h"
#include "mesh/implicit/zero_set.h"

namespace umtet {

/// The tets of any mesh in which psi changes sign, with their vertices: where the linear interpolant of psi is zero.
struct CutTets {
  std::vector<Vec3> x;
  std::vector<double> psi;                ///< at x; what is no finite number counts as outside
  std::vector<std::uint8_t> on_boundary;  ///< of the mesh
  std::vector<Tet> tets;                  ///< indices into x
};

/// Topology of the zero set of the linear interpolant, as zero_set_topology() of a grid has it: cut edges, triangles
/// and tets are the vertices, edges and faces of a polygonal surface, always a 2-manifold inside the mesh. `spacing` is
/// the longest cut edge / sqrt(3): the grid of cubes of that edge has edges as long.
///
/// Cost: sorting the edges. The result depends on the order of x, and not on that of the tets.
/// \throw std::length_error  2^31 cut edges
ZeroSetTopology zero_set_topology(const CutTets& cut);

}  // namespace umtet
