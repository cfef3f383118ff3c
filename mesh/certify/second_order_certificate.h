#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common/context.h"
#include "mesh/core/implicit_function.h"
#include "mesh/core/quadratic_tet_mesh.h"

namespace umtet {

/// What is true of tets of second order besides what is true of their corners (certificate.h), measured without trust
/// in how they were made. Lengths are in model units, ratios in h.
struct SecondOrderCertificate {
  std::size_t n_nodes = 0;                  ///< corners and mid-sides that a tet uses
  std::size_t n_boundary_mid_sides = 0;     ///< of edges of boundary faces, walls included
  std::size_t n_torn_edges = 0;             ///< edges whose tets do not all have the same mid-side
  std::size_t n_nonpositive_jacobians = 0;  ///< tets whose det dx/dl is not proved to be positive everywhere
  double volume = 0;                        ///< exact integral of the determinants but for rounding, model units^3
  /// Bounds of the least of min det / mean det over all tets: 1 where all edges are straight, with mid-sides at their
  /// middles.
  double min_scaled_jacobian_lower = 0, min_scaled_jacobian_upper = 0;
  double h = 0;
  double coordinate_rounding = 0;
  std::optional<double> max_mid_side_distance_over_h;  ///< |psi| / |grad psi| at boundary mid-sides off the walls
  std::size_t n_mid_sides_off_surface = 0;             ///< those of them farther than kVertexTolerance h and rounding
  /// From the curved faces, at their centroids and half-way from there to the corners, to psi = 0: the same where that
  /// is at most .01 h, else to the closest points.
  std::optional<double> max_face_distance_over_h, rms_face_distance_over_h;
};

/// A mesh and what backs it. The referenced objects must outlive the call.
struct SecondOrderInput {
  const QuadraticTetMesh* mesh = nullptr;
  double h = 0;                                       ///< > 0
  std::optional<ImplicitFunctionRef> psi;             ///< optional: distances; thread-safe
  double coordinate_rounding = 0;                     ///< as in CertificateInput
  const std::vector<Triangle>* wall_faces = nullptr;  ///< optional: boundary that is not of psi = 0
  Context context = {};
};

/// Measures everything above. Does not judge. Distances and result are independent of threads.
/// Cost: .3 microseconds a tet, four values of psi a boundary face.
/// \throw std::invalid_argument without a mesh, tets or h, for an index out of range or a tet that repeats a corner;
///        Cancelled
SecondOrderCertificate certify_second_order(const SecondOrderInput&);

/// The reasons why it fails, empty = pass: a Jacobian that is not positive, torn edges, boundary mid-sides off psi = 0.
/// @param n_named  this many mid-sides may be off psi = 0: they were put back for the Jacobians, and are reported
std::vector<std::string> failures(const SecondOrderCertificate&, std::size_t n_named = 0);

}  // namespace umtet
