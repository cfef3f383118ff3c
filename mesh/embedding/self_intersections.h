#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "common/context.h"
#include "mesh/core/tet_mesh.h"

namespace umtet {

/// Pairs of faces, the lesser first and ascending, that meet elsewhere than in the vertices or the edge they share:
/// every pair of a surface, by exact predicates on the pairs whose boxes touch.
/// Degenerate faces, and pairs of the same three vertices, are not seen: a boundary of positive tets has none of the
/// first, a manifold none of the second but where it is two faces back to back.
/// Cost: O(n log n) where faces are of similar size. Threads over leaves, the same result for any number of them.
/// \throw std::invalid_argument for an index out of range, Cancelled
std::vector<std::array<int, 2>> self_intersections(const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                                                   const Context& context = {});

/// Components of a closed, oriented surface without self-intersections that are not where a solid has them: on its
/// outer side the winding number of the whole surface has to be 0, on its inner side 1. A body within
/// another one, a cavity without a body around it. Ascending.
/// @param component    of each face, 0 .. n_components - 1
/// \pre closed manifold, no self_intersections()
std::vector<int> wrongly_nested(const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                                const std::vector<int>& component, std::size_t n_components,
                                const Context& context = {});

// Its parts, for a surface that nobody has as a whole.

/// Six times the signed volume within a component, and of what magnitudes it is the sum.
struct EnclosedVolume {
  double sum = 0, magnitude = 0;

  /// @param from  a corner of the first face of the component
  void add(const Vec3& from, const Vec3& a, const Vec3& b, const Vec3& c);
  int sign() const;  ///< 0 where that is rounding
};
/// For the c-th point the winding number around it of all of these faces but those of component c, where it begins.
std::vector<int> windings(const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                          const std::vector<int>& component, const std::vector<Vec3>& points,
                          const Context& context = {});
/// @param winding  around a corner of the component, of all others
bool is_wrongly_nested(const EnclosedVolume& volume, int winding);

}  // namespace umtet
