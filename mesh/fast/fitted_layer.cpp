#include "mesh/fast/fitted_layer.h"

#include "mesh/fast/projection/backtracking_projection.h"
#include "mesh/fast/smoothing/tangential_relaxation.h"

namespace umtet {

FittedLayer fit_layer(PNormSmoother& smoother, ImplicitFunctionRef psi, const FastParams& params, const LayerFit& fit,
                      const Context& context) {
  FittedLayer made;
  bool is_short = false;
  if (!fit.is_on_surface) {
    const ProjectionReport projection = project(smoother, psi, params.projection, context);
    made.psi_evaluations += projection.psi_evaluations;
    is_short = smoother.sum(projection.not_arrived.size()) != 0;
  }
  made.projected = smoother.layer().V;
  context.report("relax", .3);
  smoother.enqueue_all();
  made.psi_evaluations += smoother.run(psi, fit.smoothing, context).psi_evaluations;
  if (fit.inside) {
    const TangentialRelaxationParams chords{.least_quality = params.smoothing.target};
    made.psi_evaluations +=
        relax_tangentially(smoother, *fit.inside, psi, chords, fit.smoothing, context).psi_evaluations;
  }
  // Smoothing may have made room for vertices that a tet held back.
  if (is_short) made.psi_evaluations += project(smoother, psi, params.projection, context).psi_evaluations;
  return made;
}

}  // namespace umtet
