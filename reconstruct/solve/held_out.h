#pragma once

#include "reconstruct/solve/fit_ssd.h"

namespace umtet {

/// How well psi that is fitted to some samples of a surface explains others of it (cross-validation).
struct HeldOutResidual {
  double spacing = 0;         ///< h of the lattice, model units
  double rms_value = 0;       ///< of psi at the others, model units
  double normal_defect = 0;   ///< mean of |grad psi(x_i) - n_i|^2 there
  double opposed_share = 0;   ///< share of them with n_i . grad psi(x_i) < 0
  bool bounds_a_body = true;  ///< psi < 0 does not reach the wall of its box
  /// rms_value^2 / h^2 + normal_defect: twice the data terms of the fit, by sample, with l = h. With normals that bound
  /// no body, or that follow noise, it is several times what it is with right ones.
  double energy() const;
};

/// @param known     samples that are fitted, on a lattice of .6 times their distance: it resolves two sheets that are
///                  one spacing apart
/// @param held_out  samples that measure; not empty
/// @param noise     standard deviation of the samples along the normal, model units
/// Throws as fit_ssd. Cost: of 4000 known samples half a second of one core.
HeldOutResidual held_out_residual(const OrientedPointCloud& known, const OrientedPointCloud& held_out, double noise,
                                  const Context& context = {});

}  // namespace umtet
