#pragma once

#include <Eigen/Sparse>

#include "reconstruct/basis/lme_scattered.h"
#include "reconstruct/solve/ssd_operator.h"

namespace umtet {

/// A of an SsdOperator as a sparse matrix: the reference for small problems, up to 1331 entries a row at R = 3.
Eigen::SparseMatrix<double> assemble(const SsdOperator& op);

/// Solves A c = r by Eigen's SimplicialLDLT.
/// \throw SolveError  the factorisation failed
std::vector<double> solve_assembled(const SsdOperator& op);

/// The same functional over scattered max-ent functions of any node set, assembled and solved directly.
///
/// The Hessian energy is integrated over the hull of the nodes with Gauss points (2 x 2 x 2) on a grid of cells of edge
/// `quadrature_cell`; points outside the hull, where no max-ent function exists, do not count.
/// @param samples  w_value, w_gradient and normal of each; xi in the nodes' own (model) units
/// @param energy_weight  multiplies ½ ∫ H:H dV
/// @return coefficients f_a, one per node
/// \throw SolveError  the factorisation failed, or a sample lies outside the hull of the nodes
std::vector<double> fit_scattered(const LmeScattered& basis, const std::vector<SsdSample>& samples,
                                  double energy_weight, double quadrature_cell);

}  // namespace umtet
