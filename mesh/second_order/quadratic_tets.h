#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/context.h"
#include "mesh/core/implicit_function.h"
#include "mesh/core/quadratic_tet_mesh.h"
#include "mesh/implicit/closest_point.h"

namespace umtet {

/// Parameters of quadratic_tets().
struct SecondOrderParams {
  ClosestPointParams closest_point;
  /// Mid-sides are relaxed around a tet whose min det / mean det may be below this. A higher target raises the least
  /// value and the time; bodies that are one edge thick do not reach the target.
  double target = .3;
  /// Where min det / mean det is still not proved to exceed this value, mid-sides move back towards their chords, off
  /// psi = 0. Relaxation makes this last resort rare.
  double least = .02;
  int sweeps = 30;  ///< sweeps of relaxation; >= 0
};

/// All broken constraints, not just the first.
std::vector<std::string> problems(const SecondOrderParams&);

/// Ten-node tets, and statistics of the changes made for their Jacobians.
struct SecondOrder {
  QuadraticTetMesh mesh;                ///< the first vertices are those of the linear mesh
  std::vector<int> boundary_mid_sides;  ///< mid-sides of edges of the curved faces, ascending indices into mesh.V
  std::vector<int> off_surface;         ///< boundary mid-sides that are not on psi = 0, ascending
  std::size_t n_unprojected = 0;        ///< mid-sides in off_surface without a point of psi = 0 near their chord
  std::size_t n_slid = 0;               ///< boundary mid-sides moved along psi = 0
  std::size_t n_relaxed = 0;            ///< mid-sides inside that are not at the middle of their chord
  std::size_t n_psi_evaluations = 0;    ///< upper bound, for the projections
};

/// Ten-node tets whose boundary follows psi = 0 to second order, made from the corners of a linear mesh.
///
/// 1. Mid-sides begin at the middles of the edges. Mid-sides of edges of `curved_faces` move to their closest points on
///    psi = 0.
/// 2. Around every tet with min det dx/dl / mean det < params.target, mid-sides take Gauss-Newton steps, one after the
///    other, on  sum over the tets at the edge and their 20 coefficients of max(0, params.target - c / (6 |K|))^2.
///    Boundary mid-sides move along psi = 0, the others anywhere. Nothing moves where the coefficients are above the
///    target.
/// 3. Last resort: the mid-sides of a tet whose least Jacobian does not exceed params.least are halved towards their
///    chords four times, then put on them. A tet with all mid-sides on their chords is the linear tet, so the loop
///    ends.
///
/// @param mesh          positively oriented tets
/// @param curved_faces  the boundary faces that lie on psi = 0; empty: all edges stay straight
/// @param psi           C2 near the boundary, negative inside; thread-safe
/// @param h             edge length that the tolerances of params.closest_point are relative to, model units, > 0
/// \throw std::invalid_argument for an index out of range, a face with an edge of no tet, params with problems();
///        Cancelled
/// Cost: 1.5 closest points per face and .2 microseconds per tet, and more only where mid-sides are relaxed; 140 bytes
/// per tet. The result does not depend on threads.
SecondOrder quadratic_tets(const TetMesh& mesh, const std::vector<Triangle>& curved_faces, ImplicitFunctionRef psi,
                           double h, const SecondOrderParams& params = {}, const Context& context = {});

}  // namespace umtet
