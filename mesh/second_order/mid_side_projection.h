#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/context.h"
#include "mesh/core/implicit_function.h"
#include "mesh/core/quadratic_tet_mesh.h"
#include "mesh/implicit/closest_point.h"
#include "mesh/second_order/mid_side_numbers.h"

// The first steps of quadratic_tets(), separate for callers with a part of a mesh each.
namespace umtet {

/// Role of a mid-side node.
enum class MidSide : std::uint8_t {
  Free,     ///< inside the body, or on a boundary edge that is not curved
  Surface,  ///< on psi = 0, and may slide along it
  Fixed,    ///< on a curved edge, but off psi = 0
};

/// An edge of the curved faces: the index of its mid-side among all nodes, and its corners, the lower one first.
struct CurvedEdge {
  int mid_side, a, b;
  auto operator<=>(const CurvedEdge&) const = default;
};

/// The edges of faces, ascending, each once. \throw std::invalid_argument for a face with an edge of no tet
std::vector<CurvedEdge> edges_of_faces(const std::vector<Triangle>& faces, const MidSideNumbers& number,
                                       std::size_t n_corners);

/// Projects the mid-sides of edges onto psi = 0. They become Surface; mid-sides without a closest point near them stay
/// and become Fixed. Each mid-side is projected independently.
/// @param h     edge length that the tolerances of params are relative to, model units, > 0
/// @param V     nodes, corners first
/// @param kind  role of every mid-side
/// @return upper bound on the number of evaluations of psi
/// \throw Cancelled
std::size_t project_mid_sides(const std::vector<CurvedEdge>& edges, ImplicitFunctionRef psi, double h,
                              const ClosestPointParams& params, std::vector<Vec3>& V, std::vector<MidSide>& kind,
                              const Context& context = {});

/// The tets with a mid-side on psi = 0 whose least determinant is not proved to exceed `bar` times its mean, ascending.
/// \throw Cancelled
std::vector<int> tets_below(const QuadraticTetMesh& mesh, const std::vector<MidSide>& kind, double bar,
                            const Context& context = {});

}  // namespace umtet
