#pragma once

#include <cstdint>
#include <vector>

#include "common/disjoint_sets.h"
#include "mesh/implicit/zero_set.h"

namespace umtet {

/// An edge whose ends differ in the sign of psi: a vertex of the polygonal surface that a count of psi = 0 is about.
struct CutEdge {
  Vec3 point;                           ///< where psi = 0, linear
  double area = 0;                      ///< its share of the faces around it
  std::int32_t faces_minus_edges2 = 0;  ///< twice the cut tets minus cut triangles that are counted here
  bool on_wall = false;
};

/// The pieces that these edges are joined to, with their points and areas; not the spacing.
ZeroSetTopology topology_of(const std::vector<CutEdge>& edges, DisjointSets& surface);

}  // namespace umtet
