#pragma once

#include <cstddef>
#include <vector>

#include "common/vec3.h"

namespace umtet {

/// A connected part of the boundary that was closed without samples, up to the samples at its rim. Lengths in model
/// units.
struct ClosedHole {
  Vec3 centre = Vec3::Zero();  ///< mean of its surface, model coordinates
  double area = 0;
  double area_fraction = 0;  ///< of the surface on psi = 0
  double deepest = 0;        ///< largest distance of its vertices to the nearest sample
  double deepest_over_spacing = 0;
  double rim_length = 0;    ///< of all its rims
  double rim_diameter = 0;  ///< largest distance between two points of its rims
  std::size_t n_rims = 0;   ///< closed lines in which it ends; 0: a piece of the boundary that no sample is near
};

/// What of the boundary of a mesh is a guess.
struct SupportReport {
  double radius = 0;                     ///< farther than this from every sample the boundary is unsupported
  double unsupported_area_fraction = 0;  ///< of the boundary
  std::size_t n_closed_holes = 0;
  std::vector<ClosedHole> closed_holes{};  ///< the largest of them, largest first
  /// Handles of the boundary that are there because of what was closed: its genus, less the genus of what is left when
  /// all closed holes are cut out and each rim gets a disc.
  int n_guessed_handles = 0;
  std::size_t n_guessed_pieces = 0;  ///< pieces of the boundary that no sample is near
};

}  // namespace umtet
