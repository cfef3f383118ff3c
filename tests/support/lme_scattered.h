#pragma once

#include <memory>
#include <vector>

#include "common/vec3.h"
#include "reconstruct/basis/lme_prior.h"

namespace umtet {

/// Values of the max-ent functions of a node set at one point.
struct LmeValues {
  std::vector<int> node;  ///< the nodes within the support, ascending
  std::vector<double> N;
  std::vector<Vec3> grad;
  std::vector<Mat3> hess;
  bool converged = false;  ///< false: x is not inside the hull of the nodes within the support
};

/// Local max-ent functions on an arbitrary node set, three-dimensional, by Newton's method on log Z. They are the
/// reference for the lattice functions, and serve nodes that are not on a lattice.
///
/// p_a = w_a e^{lambda . d_a} / Z, d_a = x - x_a, sum p_a d_a = 0, W_a = p_a / w_a; with J = sum p d d^T,
///   d_j p  = W d_j w + p e_j,   e_j = L_j . d - sum W d_j w,   L_j = -J^-1 (unit_j + sum W d_j w d)
///   d_jk p = T_jk - p (sum T_jk + d . J^-1 sum T_jk d),   T_jk = W d_jk w + W (d_j w e_k + d_k w e_j) + p e_j e_k.
///                                                                                      [ArroyoOrtiz2006, Section 3]
class LmeScattered {
 public:
  /// @param spacing  length scale that makes the prior's arguments dimensionless: t = d / spacing on each axis
  LmeScattered(std::vector<Vec3> nodes, const LmePrior& prior, double spacing);
  ~LmeScattered();
  LmeScattered(LmeScattered&&) noexcept;
  LmeScattered& operator=(LmeScattered&&) noexcept;

  const std::vector<Vec3>& nodes() const { return nodes_; }
  double spacing() const { return spacing_; }
  /// Cost: one radius search and 5-10 Newton steps over the neighbours. Thread-safe.
  LmeValues evaluate(const Vec3& x) const;
  /// Nodes whose functions can be nonzero together with the function of node a, ascending, a included.
  std::vector<int> overlapping(int a) const;

 private:
  struct Tree;
  double reach() const;  // maximum distance from its node at which a function is nonzero
  std::vector<Vec3> nodes_;
  LmePrior prior_;
  double spacing_;
  std::unique_ptr<Tree> tree_;
};

}  // namespace umtet
