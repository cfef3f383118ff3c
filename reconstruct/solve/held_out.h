#pragma once

#include "reconstruct/solve/fit_ssd.h"

namespace umtet {

/// Cross-validation: how well a psi fitted to some samples of a surface explains others.
struct HeldOutResidual {
  double spacing = 0;         ///< spacing h of the lattice, model units
  double rms_value = 0;       ///< rms of psi at the held-out samples, model units
  double normal_defect = 0;   ///< mean of |grad psi(x_i) - n_i|^2 there
  double opposed_share = 0;   ///< fraction of them with n_i . grad psi(x_i) < 0
  bool bounds_a_body = true;  ///< psi < 0 does not reach the wall of its box
  /// rms_value^2 / h^2 + normal_defect: twice the data terms of the fit, per sample, with l = h. For normals that do
  /// not bound a body, or that follow noise, it is several times its value for right normals.
  double energy() const;
};

/// Fits psi to some samples and measures it at others.
/// @param known     samples for the fit, on a lattice of .6 times their distance, which resolves two sheets one spacing
///                  apart
/// @param held_out  samples for the measurement; not empty
/// @param noise     standard deviation of the samples along the normal, model units
/// Throws the exceptions of fit_ssd(). Cost: half a second of one core for 4000 known samples.
HeldOutResidual held_out_residual(const OrientedPointCloud& known, const OrientedPointCloud& held_out, double noise,
                                  const Context& context = {});

}  // namespace umtet
