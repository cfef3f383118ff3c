#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/context.h"
#include "mesh/core/implicit_function.h"
#include "mesh/fast/fast_params.h"
#include "mesh/fast/smoothing/p_norm_smoothing.h"

namespace umtet {

/// Options for fitting a layer to psi = 0.
struct LayerFit {
  SmoothingParams smoothing;
  bool is_on_surface = false;  ///< the boundary vertices are on psi = 0 already
  /// Whether each vertex of the layer is inside, for relax_tangentially(); null: no tangential relaxation. It evaluates
  /// psi at every face, which is half the cost of an update.
  const std::vector<std::uint8_t>* inside = nullptr;
};

/// Result of fit_layer().
struct FittedLayer {
  std::vector<Vec3> projected;  ///< positions between projection and relaxation, by vertex of the layer
  std::size_t psi_evaluations = 0;
};

/// Fits a layer to psi = 0: moves its boundary vertices towards psi = 0 without inverting a tet, and relaxes the layer.
/// The steps are project(), PNormSmoother::run() over the whole layer, relax_tangentially(), and project() again if a
/// vertex was held back. Reports the step "relax".
/// \throw Cancelled
FittedLayer fit_layer(PNormSmoother& smoother, ImplicitFunctionRef psi, const FastParams& params, const LayerFit& fit,
                      const Context& context = {});

}  // namespace umtet
