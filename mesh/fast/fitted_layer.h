#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/context.h"
#include "mesh/core/implicit_function.h"
#include "mesh/fast/fast_params.h"
#include "mesh/fast/p_norm_smoothing.h"

namespace umtet {

/// How a layer is fitted to psi = 0.
struct LayerFit {
  SmoothingParams smoothing;
  bool is_on_surface = false;  ///< its boundary vertices are on psi = 0 already
  /// relax_tangentially(), which asks psi at every face: half the cost of an update. With it, whether each vertex of
  /// the layer is inside
  const std::vector<std::uint8_t>* inside = nullptr;
};

struct FittedLayer {
  std::vector<Vec3> projected;  ///< places between projection and relaxation, by vertex of the layer
  std::size_t psi_evaluations = 0;
};

/// Boundary vertices of the layer go to psi = 0, as far as no tet inverts, and the layer is relaxed: project(), then
/// PNormSmoother::run() over all of it, then relax_tangentially(), and project() again where a vertex was held back.
/// Reports the step "relax". \throw Cancelled
FittedLayer fit_layer(PNormSmoother& smoother, ImplicitFunctionRef psi, const FastParams& params, const LayerFit& fit,
                      const Context& context = {});

}  // namespace umtet
