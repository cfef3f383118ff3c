#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "common/context.h"
#include "mesh/core/tet_mesh.h"

namespace umtet {

/// Self-intersections of a triangle surface: all pairs of faces, the lesser first and ascending, that intersect outside
/// of their common vertices and edge. Exact predicates test all pairs whose boxes touch.
///
/// Degenerate faces, and pairs with the same three vertices, are not detected. A boundary of positive tets has no
/// degenerate face, and a manifold has no such pair unless it consists of two faces back to back.
/// Cost: O(n log n) for faces of similar size. Uses threads over leaves; the result is the same for any number of them.
/// \throw std::invalid_argument for an index out of range, Cancelled
std::vector<std::array<int, 2>> self_intersections(const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                                                   const Context& context = {});

/// Components of a closed, oriented surface without self-intersections whose nesting is impossible for a solid,
/// ascending. The winding number of the whole surface has to be 0 on a component's outer side and 1 on its inner side.
/// Wrong are a body inside another body, and a cavity without a body around it.
/// @param component    per face, 0 .. n_components - 1
/// \pre closed manifold, no self_intersections()
std::vector<int> wrongly_nested(const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                                const std::vector<int>& component, std::size_t n_components,
                                const Context& context = {});

// The steps of wrongly_nested(), for a surface that is distributed over processes.

/// Six times the signed volume enclosed by a component, with the sum of the magnitudes of its terms.
struct ComponentVolume {
  double sum = 0, magnitude = 0;

  /// @param from  a corner of the first face of the component
  void add(const Vec3& from, const Vec3& a, const Vec3& b, const Vec3& c);
  int sign() const;  ///< 0 if the sum is within rounding
};
/// For the c-th point, where component c begins, the winding number around it of all these faces except those of
/// component c.
std::vector<int> windings(const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                          const std::vector<int>& component, const std::vector<Vec3>& points,
                          const Context& context = {});
/// @param winding  winding number of all other components around a corner of the component
bool is_wrongly_nested(const ComponentVolume& volume, int winding);

}  // namespace umtet
