#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/context.h"
#include "mesh/core/implicit_function.h"
#include "mesh/core/quadratic_tet_mesh.h"
#include "mesh/implicit/closest_point.h"

namespace umtet {

struct SecondOrderParams {
  ClosestPointParams closest_point;
  /// Mid-sides are relaxed around a tet whose min det / mean det may be below this. A higher target raises the least
  /// value and the time; in bodies one edge thick the target itself is not reached.
  double target = .3;
  /// Where it is still not proved to be above this, mid-sides go back towards their chords, off psi = 0: a last resort
  /// that relaxation makes rare.
  double least = .02;
  int sweeps = 30;  ///< of relaxation; >= 0
};

/// Every broken constraint, not just the first.
std::vector<std::string> problems(const SecondOrderParams&);

/// Tets of second order, and what had to be done for their Jacobians.
struct SecondOrder {
  QuadraticTetMesh mesh;                ///< the first vertices are those of the linear mesh
  std::vector<int> boundary_mid_sides;  ///< of edges of the curved faces, ascending indices into mesh.V
  std::vector<int> off_surface;         ///< those of them that are not on psi = 0, ascending
  std::size_t n_unprojected = 0;        ///< those of these that found no point of psi = 0 near their chord
  std::size_t n_slid = 0;               ///< boundary mid-sides moved along psi = 0
  std::size_t n_relaxed = 0;            ///< mid-sides inside that are not at the middle of their chord
  std::size_t n_psi_evaluations = 0;    ///< at most, for the projections
};

/// Tets with 10 nodes whose boundary follows psi = 0 to second order, on the corners of a linear mesh.
///
/// 1. Mid-sides are the middles of the edges; those of edges of `curved_faces` go to their closest points on psi = 0.
/// 2. Around every tet with min det dx/dl / mean det < params.target, mid-sides take Gauss-Newton steps, one after the
///    other, on  sum over the tets at the edge and their 20 coefficients of max(0, params.target - c / (6 |K|))^2,
///    boundary mid-sides along psi = 0, the others anywhere. Nothing moves where the coefficients are above the target.
/// 3. Last resort: the mid-sides of a tet whose least Jacobian is not above params.least are halved towards their
///    chords, four times, then put there. A tet with all of them there is the linear one: this ends.
///
/// @param mesh          positively oriented tets
/// @param curved_faces  the boundary faces that lie on psi = 0; empty: all edges stay straight
/// @param psi           C2 near the boundary, negative inside; thread-safe
/// @param h             edge length that the tolerances of params.closest_point are relative to, model units, > 0
/// \throw std::invalid_argument for an index out of range, a face with an edge of no tet, params with problems();
///        Cancelled
/// Cost: 1.5 closest points a face and .2 microseconds a tet, more only where mid-sides are relaxed; 140 bytes a tet.
/// Result independent of threads.
SecondOrder quadratic_tets(const TetMesh& mesh, const std::vector<Triangle>& curved_faces, ImplicitFunctionRef psi,
                           double h, const SecondOrderParams& params = {}, const Context& context = {});

}  // namespace umtet
