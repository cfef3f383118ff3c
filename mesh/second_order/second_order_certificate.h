#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common/context.h"
#include "mesh/core/implicit_function.h"
#include "mesh/core/quadratic_tet_mesh.h"

namespace umtet {

/// Measured properties of ten-node tets beyond those of their corners (certificate.h), independent of how the mesh was
/// made. Lengths are in model units, ratios in h.
struct SecondOrderCertificate {
  std::size_t n_nodes = 0;                  ///< corners and mid-sides used by a tet
  std::size_t n_boundary_mid_sides = 0;     ///< mid-sides of edges of boundary faces, walls included
  std::size_t n_torn_edges = 0;             ///< edges whose tets do not all share one mid-side
  std::size_t n_nonpositive_jacobians = 0;  ///< tets whose det dx/dl is not proved to be positive everywhere
  double volume = 0;                        ///< integral of the determinants, exact except for rounding, model units^3
  /// Bounds on the least min det / mean det over all tets. It is 1 if all edges are straight, with mid-sides at their
  /// middles.
  double min_scaled_jacobian_lower = 0, min_scaled_jacobian_upper = 0;
  double h = 0;
  double coordinate_rounding = 0;
  std::optional<double> max_mid_side_distance_over_h;  ///< |psi| / |grad psi| at boundary mid-sides off the walls
  std::size_t n_mid_sides_off_surface = 0;             ///< boundary mid-sides off the walls whose distance exceeds
                                                       ///< kVertexTolerance h and rounding
  /// Distance from the curved faces to psi = 0, at their centroids and half-way from there to the corners: |psi| /
  /// |grad psi| where this is at most .01 h, else the distance to the closest point.
  std::optional<double> max_face_distance_over_h, rms_face_distance_over_h;
};

/// A quadratic mesh and the data it is checked against. The referenced objects must outlive the call.
struct SecondOrderInput {
  const QuadraticTetMesh* mesh = nullptr;
  double h = 0;                                       ///< > 0
  std::optional<ImplicitFunctionRef> psi;             ///< optional: distances; thread-safe
  double coordinate_rounding = 0;                     ///< as in CertificateInput
  const std::vector<Triangle>* wall_faces = nullptr;  ///< optional: boundary faces that are not on psi = 0
  Context context = {};
};

/// Measures all fields of a second-order certificate, without a verdict. The result does not depend on threads.
/// Cost: .3 microseconds per tet, four values of psi per boundary face.
/// \throw std::invalid_argument without a mesh, tets or h, for an index out of range or a tet that repeats a corner;
///        Cancelled
SecondOrderCertificate certify_second_order(const SecondOrderInput&);

/// The reasons why a certificate fails; empty if it passes. The reasons are a Jacobian that is not positive, torn
/// edges, and boundary mid-sides off psi = 0.
/// @param n_named  this many mid-sides may be off psi = 0: they were moved back for the Jacobians, and are reported
std::vector<std::string> failures(const SecondOrderCertificate&, std::size_t n_named = 0);

}  // namespace umtet
