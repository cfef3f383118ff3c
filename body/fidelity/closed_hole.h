#pragma once

#include <cstddef>
#include <vector>

#include "common/vec3.h"

namespace umtet {

/// A connected part of the boundary that was closed without samples. It ends at the samples of its rim. Lengths are in
/// model units.
struct ClosedHole {
  Vec3 centre = Vec3::Zero();  ///< mean of its surface, model coordinates
  double area = 0;
  double area_fraction = 0;  ///< area divided by the area of all boundary faces on psi = 0
  double deepest = 0;        ///< largest distance from a vertex of the part to the nearest sample
  double deepest_over_spacing = 0;
  double rim_length = 0;    ///< total length of its rims
  double rim_diameter = 0;  ///< largest distance between two points of its rims
  /// Number of closed lines that bound it; 0: it is a complete piece of the boundary without a sample near it.
  std::size_t n_rims = 0;
};

/// The parts of the boundary of a mesh that are guesses.
struct SupportReport {
  double radius = 0;                     ///< the boundary is unsupported where every sample is farther away than this
  double unsupported_area_fraction = 0;  ///< unsupported share of the area of the boundary
  std::size_t n_closed_holes = 0;
  std::vector<ClosedHole> closed_holes{};  ///< the largest holes, in descending order
  /// Number of handles of the boundary that are guesses: the genus of the boundary, minus its genus after every closed
  /// hole has been removed and every rim closed with a disc.
  int n_guessed_handles = 0;
  std::size_t n_guessed_pieces = 0;  ///< number of pieces of the boundary without a sample near them
};

}  // namespace umtet
