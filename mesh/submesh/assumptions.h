#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "mesh/submesh/submesh.h"

namespace umtet {

/// The places where omega_h breaks an assumption of Algorithm 1. A broken assumption need not break the mesh; it is
/// evidence for a failure at the same place.
struct BrokenAssumption {
  std::size_t count = 0;        ///< number of faces or tets that break it
  std::vector<bool> at_vertex;  ///< per vertex of omega_h, true if it belongs to such a face or tet; empty if none does

  bool holds() const { return count == 0; }
  /// True if one of the vertices belongs to a face or tet that breaks it.
  bool is_broken_at(std::span<const int> vertices) const;
};

/// Positive faces that are shared by two positively cut tets                              [Rangarajan2018, Section 5.2]
///
/// The algorithm takes the set of positive faces for the boundary of omega_h, but such a face is inside omega_h: the
/// domain is too thin or too curved for h there. `count` counts each face once. Cost: a sort of the positive faces.
BrokenAssumption double_positive_faces(const Submesh&);

/// The greatest conditioning angle, and the tets with an angle that is not acute.
struct ConditioningAngles {
  double max_deg = 0;          ///< maximum over all tets, 0 without positive faces
  BrokenAssumption not_acute;  ///< positively cut tets with an angle of 90 degrees or more, up to rounding
};

/// Conditioning angles of all positively cut tets
///                                                 [Rangarajan2018, Section 5.3, Fig. 3C; KabariaLew2017, Theorem 3.2]
///
/// They must be acute for the closest point projection to be injective on each positive face. The proximal vertex of a
/// positively cut tet is the vertex of its positive face that is closest to the boundary. The conditioning angles are
/// the dihedral angles between the positive face and the two other faces that meet at this vertex. In a background mesh
/// of acute tets they are acute for any domain.
///
/// @param distance  |phi| at submesh.positive_vertices, in their order; among equally close vertices the first of the
///                  face is proximal
/// \throw std::invalid_argument if the number of distances differs from the number of positive vertices
ConditioningAngles conditioning_angles(const Submesh& submesh, std::span<const double> distance);

}  // namespace umtet
