#pragma once

#include <cstdint>
#include <vector>

#include "mesh/core/boundary_strata.h"
#include "mesh/core/tet_mesh.h"

namespace umtet {

/// The part of omega_h that moves: the tets of a few layers behind the boundary, with the rings of their vertices. All
/// other vertices keep their background positions.
struct ActiveLayer {
  enum class Role : std::uint8_t {
    Fixed,    ///< the ring is not complete in the layer, or the vertex is beyond the last layer
    Inner,    ///< relaxes freely
    Boundary  ///< a positive vertex: projected onto psi = 0, relaxes in its tangent plane
  };
  std::vector<Vec3> V;
  std::vector<Tet> C;      ///< indices into V, positively oriented in the background mesh
  std::vector<Role> role;  ///< per vertex
  /// Colour per vertex; vertices of one colour share no tet. Small numbers from 0; arbitrary or -1 for Fixed vertices.
  std::vector<int> colour;
  std::vector<int> ring_begin, ring;  ///< the tets of vertex v: ring[ring_begin[v]] .. ring[ring_begin[v + 1] - 1]
  double h = 0;                       ///< mean edge length of the background mesh, model units
  std::vector<double> local_h;        ///< per vertex, mean length of its background edges; empty: h everywhere
  /// The strata of a piecewise smooth boundary, and per vertex the one that a Boundary vertex moves on. Null: all of
  /// them move on psi = 0.
  const BoundaryStrata* strata = nullptr;
  std::vector<int> stratum;
  std::vector<BallOnPatch> ball;  ///< per vertex, as BoundaryStrata::foot() takes it; empty: none is known

  double h_at(int v) const { return local_h.empty() ? h : local_h[v]; }
};

/// Computes ring_begin and ring, ascending, from V and C.
void list_rings(ActiveLayer& layer);

/// Greedy colouring: each vertex that is not Fixed, in ascending order, takes the least colour unused by the lower
/// vertices of its ring.
void colour_greedily(ActiveLayer& layer);

}  // namespace umtet
