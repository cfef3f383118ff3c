#pragma once

#include <cstdint>
#include <vector>

#include "common/disjoint_sets.h"
#include "mesh/implicit/zero_set.h"

namespace umtet {

/// An edge whose ends differ in the sign of psi: a vertex of the polygonal surface whose topology is counted.
struct CutEdge {
  Vec3 point;                           ///< zero of psi on the edge, by linear interpolation
  double area = 0;                      ///< its share of the area of the faces around it
  std::int32_t faces_minus_edges2 = 0;  ///< twice (cut tets minus cut triangles), of those counted at this edge
  bool on_wall = false;
};

/// The components formed by these edges, with points and areas; `spacing` is not set.
ZeroSetTopology topology_of(const std::vector<CutEdge>& edges, DisjointSets& surface);

}  // namespace umtet
