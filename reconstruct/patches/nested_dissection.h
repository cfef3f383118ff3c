#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "common/vec3.h"

namespace umtet {

/// A symmetric positive definite system A x = b that is a sum over elements, each with a few of the unknowns.
struct ElementSystem {
  int n_unknowns = 0;
  std::vector<Vec3> centres;               ///< centres of the elements
  std::vector<std::vector<int>> unknowns;  ///< unknowns of each element; every unknown has an element
  /// Adds the matrix (its lower triangle) and the right-hand side of an element. It must be thread-safe.
  std::function<void(int element, Eigen::MatrixXd& A, Eigen::VectorXd& b)> add;
};

/// Solves the system by Cholesky factors of dense fronts, in the order of nested dissection [George1973; Duff1983].
///
/// The elements are halved along the longest side of the box of their centres until few are left. The matrices of both
/// halves are added, and the unknowns that no other element has are eliminated. For n unknowns near a surface this
/// takes n^(3/2) operations. The result does not depend on the number of threads.
/// @return x; empty if A is not positive definite within rounding
Eigen::VectorXd solve_by_nested_dissection(const ElementSystem& system);

}  // namespace umtet
