#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/vec3.h"

namespace umtet {

/// A curve that leaves a corner.
struct CornerRay {
  Vec3 direction;              ///< unit vector away from the corner
  std::array<int, 2> patches;  ///< on its sides, by their numbers at the corner
  bool is_convex;
};

/// The signs of the k functions f_p at a corner that mean inside, as
///
///     psi = min over terms of max over the patches p of the term of f_p
///
/// To first order the boundary is a cone over a fan of k plane sectors, and the signs of all f_p are constant in the
/// cells between k planes. A direction is inside if its nearest point of the fan says so: n_p . u < 0 in a sector; at a
/// ray both are negative if it is convex, or one of them if it is concave. A set of patches is a term if all directions
/// where they are negative are inside, and no smaller set is one: psi has all prime implicants.
///
/// Any step into more negative signs leads from outside to inside or changes nothing, because only the sector of a
/// plane that is the boundary changes the side. So terms with negative signs are enough. A chain of max and min by the
/// convexities of the curves is right at every corner of three patches, but not at those of more.
/// @param normals  outward, of the k patches at the corner; 3 <= k <= 8
/// @param rays     the curves of the corner: two of each patch
/// @return terms as sets of bits 1 << p, ascending; empty if a patch has no two rays, or nothing is inside
std::vector<std::uint32_t> corner_terms(const std::vector<Vec3>& normals, const std::vector<CornerRay>& rays);

}  // namespace umtet
