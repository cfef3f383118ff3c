#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "mesh/core/quality_target.h"
#include "mesh/fast/p_norm_smoothing.h"

namespace umtet {

/// docs/constants.md has what other values do.
struct TangentialRelaxationParams {
  double least_chord = .1;  ///< of h: boundary faces farther than this from psi = 0 are worth a move; > 0
  double least_quality =
      kQualityTarget;  ///< mean ratio: no tet falls below it, or below the worst of its star; in (0, 1)
  /// Added to least_quality around vertices without a face farther than far_chord h from psi = 0; both >= 0
  double near_margin = .02, far_chord = .13;
  int sweeps = 6;        ///< over the vertices of such faces; >= 0
  int inner_sweeps = 3;  ///< sweeps of smoothing behind the boundary after each, to make room for the next; >= 0
};

/// Every broken constraint, not just the first.
std::vector<std::string> problems(const TangentialRelaxationParams&);

struct TangentialRelaxationReport {
  std::size_t vertices = 0;         ///< with a face that is farther from psi = 0 than least_chord h
  std::size_t moves = 0;            ///< of these, all sweeps together
  std::size_t psi_evaluations = 0;  ///< those of the smoothing included
};

/// Slides boundary vertices along psi = 0 to where the flat faces around them are nearer to it: on to ridges, above
/// all, whose curvature h does not resolve.
///
/// e = |psi| / |grad psi| is the distance at the middles of the faces around a vertex and of its edges in them.
/// A solve lowers sum e^4 by one Gauss-Newton step in the tangent plane, put back on psi = 0, and halved until the sum
/// falls, every tet of the ring keeps Q >= least_quality or more (or the worst it had) and no face is misaligned
/// further than kMisalignedCosine. After each sweep the vertices behind the boundary are smoothed while the boundary is
/// held.
///
/// Vertices are solved colour by colour: the same bytes for any number of threads.
/// @param smoother  of a layer whose boundary vertices are on psi = 0
/// @param inside    per vertex of it; boundary faces have their three vertices outside
/// @param smoothing  of the vertices behind; max_sweeps is not used
/// \throw std::invalid_argument naming every broken constraint, Cancelled
TangentialRelaxationReport relax_tangentially(PNormSmoother& smoother, const std::vector<std::uint8_t>& inside,
                                              ImplicitFunctionRef psi, const TangentialRelaxationParams& params,
                                              SmoothingParams smoothing, const Context& context = {});

}  // namespace umtet
