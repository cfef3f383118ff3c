#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "mesh/submesh/submesh.h"

namespace umtet {

/// Where omega_h breaks an assumption of Algorithm 1. Breaking one need not break the mesh: this is evidence for a
/// failure at the same place.
struct BrokenAssumption {
  std::size_t count = 0;        ///< faces or tets that break it
  std::vector<bool> at_vertex;  ///< per vertex of omega_h, true if it belongs to one of them; empty if there is none

  bool holds() const { return count == 0; }
  /// True if one of the vertices belongs to a face or tet that breaks it.
  bool is_broken_at(std::span<const int> vertices) const;
};

/// Positive faces that two positively cut tets share. The algorithm takes the set of positive faces for the boundary of
/// omega_h, and such a face is inside omega_h: the domain is too thin or too curved for h there
///                                                                                        [Rangarajan2018, Section 5.2]
/// `count` counts each of them once. Cost: a sort of the positive faces.
BrokenAssumption double_positive_faces(const Submesh&);

struct ConditioningAngles {
  double max_deg = 0;          ///< the greatest of all, 0 without positive faces
  BrokenAssumption not_acute;  ///< positively cut tets with an angle of 90 degrees or more, to rounding
};

/// The conditioning angles of all positively cut tets, which must be acute for the closest point projection to be
/// injective on each positive face                 [Rangarajan2018, Section 5.3, Fig. 3C; KabariaLew2017, Theorem 3.2]
///
/// The proximal vertex of a positively cut tet is the vertex of its positive face that is nearest to the boundary; the
/// conditioning angles are the dihedral angles between the positive face and the two other faces that meet there. A
/// background mesh of acute tets has acute ones whatever the domain.
///
/// @param distance  |phi| at submesh.positive_vertices, in their order; among equally near vertices the first of the
///                  face is proximal
/// \throw std::invalid_argument for another number of distances
ConditioningAngles conditioning_angles(const Submesh& submesh, std::span<const double> distance);

}  // namespace umtet
