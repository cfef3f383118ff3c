#pragma once

#include <Eigen/Sparse>

#include "reconstruct/solve/ssd_operator.h"

namespace umtet {

/// Assembles A of an SsdOperator as a sparse matrix. It is the reference for small problems, with up to 1331 entries
/// per row at R = 3.
Eigen::SparseMatrix<double> assemble(const SsdOperator& op);

/// Solves A c = r by Eigen's SimplicialLDLT.
/// \throw SolveError if the factorisation fails
std::vector<double> solve_assembled(const SsdOperator& op);

}  // namespace umtet
