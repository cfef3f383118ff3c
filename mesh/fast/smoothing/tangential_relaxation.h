#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "mesh/core/quality_target.h"
#include "mesh/fast/smoothing/p_norm_smoothing.h"

namespace umtet {

/// Parameters of relax_tangentially(). docs/constants.md lists the effect of other values.
struct TangentialRelaxationParams {
  double least_chord = .1;  ///< in units of h: vertices of boundary faces farther than this from psi = 0 are moved; > 0
  double least_quality =
      kQualityTarget;  ///< mean ratio: no tet falls below it, or below the worst of its star; in (0, 1)
  /// near_margin is added to least_quality around vertices without a face farther than far_chord h from psi = 0; both
  /// >= 0
  double near_margin = .02, far_chord = .13;
  int sweeps = 6;        ///< sweeps over the vertices of such faces; >= 0
  int inner_sweeps = 3;  ///< sweeps of smoothing behind the boundary after each sweep, to make room for the next; >= 0
};

/// All broken constraints, not just the first.
std::vector<std::string> problems(const TangentialRelaxationParams&);

/// Report of relax_tangentially().
struct TangentialRelaxationReport {
  std::size_t vertices = 0;         ///< vertices with a face farther from psi = 0 than least_chord h
  std::size_t moves = 0;            ///< moves of these vertices, in all sweeps together
  std::size_t psi_evaluations = 0;  ///< includes the evaluations of smoothing
};

/// Tangential relaxation: slides boundary vertices along psi = 0 to reduce the chordal error of the flat faces around
/// them. It mainly moves vertices onto ridges whose curvature h does not resolve.
///
/// e = |psi| / |grad psi| is the distance at the centroids of the faces around a vertex and at the midpoints of its
/// edges in them. A solve lowers sum e^4 by one Gauss-Newton step in the tangent plane, followed by projection onto psi
/// = 0. The step is halved until
/// - the sum falls,
/// - every tet of the ring has Q >= least_quality, or at least the ring's worst Q before,
/// - no face beyond kMisalignedCosine becomes more misaligned.
///
/// After each sweep the vertices behind the boundary are smoothed while the boundary is held. Vertices are solved
/// colour by colour; the bytes are the same for any number of threads.
/// @param smoother   smoother of a layer whose boundary vertices are on psi = 0
/// @param inside     per vertex of the layer; boundary faces have their three vertices outside
/// @param smoothing  parameters for the vertices behind the boundary; its max_sweeps is not used
/// \throw std::invalid_argument naming every broken constraint, Cancelled
TangentialRelaxationReport relax_tangentially(PNormSmoother& smoother, const std::vector<std::uint8_t>& inside,
                                              ImplicitFunctionRef psi, const TangentialRelaxationParams& params,
                                              SmoothingParams smoothing, const Context& context = {});

}  // namespace umtet
