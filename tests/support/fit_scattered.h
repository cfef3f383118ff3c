#pragma once

#include <vector>

#include "reconstruct/solve/ssd_sample.h"
#include "tests/support/lme_scattered.h"

namespace umtet {

/// SSD fit over scattered max-ent functions of any node set, assembled and solved directly.
///
/// The Hessian energy is integrated over the hull of the nodes with Gauss points (2 x 2 x 2) on a grid of cells of edge
/// `quadrature_cell`. Points outside the hull, where no max-ent function exists, are skipped.
/// @param samples  w_value, w_gradient and normal of each; xi in the (model) units of the nodes
/// @param energy_weight  multiplies ½ ∫ H:H dV
/// @return coefficients f_a, one per node
/// \throw SolveError if the factorisation fails, or a sample lies outside the hull of the nodes
std::vector<double> fit_scattered(const LmeScattered& basis, const std::vector<SsdSample>& samples,
                                  double energy_weight, double quadrature_cell);

}  // namespace umtet
