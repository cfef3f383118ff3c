#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/context.h"
#include "mesh/certify/mid_side_numbers.h"
#include "mesh/core/implicit_function.h"
#include "mesh/core/quadratic_tet_mesh.h"
#include "mesh/implicit/closest_point.h"

// The first steps of quadratic_tets(), for those who have a part of a mesh each.
namespace umtet {

/// What a mid-side may do.
enum class MidSide : std::uint8_t {
  Free,     ///< inside the body, or on an edge of it that is not to be curved
  Surface,  ///< on psi = 0, along which it may slide
  Fixed,    ///< of a curved edge, but not on psi = 0
};

/// An edge of the curved faces: its mid-side among all nodes, and its corners, the lower one first.
struct CurvedEdge {
  int mid_side, a, b;
  auto operator<=>(const CurvedEdge&) const = default;
};

/// Ascending, each once. \throw std::invalid_argument for a face with an edge that no tet has
std::vector<CurvedEdge> edges_of_faces(const std::vector<Triangle>& faces, const MidSideNumbers& number,
                                       std::size_t n_corners);

/// Mid-sides of these edges go to their closest points on psi = 0, and are Surface; those that find none near stay, and
/// are Fixed. Each by itself.
/// @param h     edge length that the tolerances of params are relative to, model units, > 0
/// @param V     nodes, corners first
/// @param kind  of every mid-side
/// @return evaluations of psi, at most \throw Cancelled
std::size_t project_mid_sides(const std::vector<CurvedEdge>& edges, ImplicitFunctionRef psi, double h,
                              const ClosestPointParams& params, std::vector<Vec3>& V, std::vector<MidSide>& kind,
                              const Context& context = {});

/// The tets with a mid-side on psi = 0 whose least determinant is not proved to be above `bar` times its mean,
/// ascending. \throw Cancelled
std::vector<int> tets_below(const QuadraticTetMesh& mesh, const std::vector<MidSide>& kind, double bar,
                            const Context& context = {});

}  // namespace umtet
