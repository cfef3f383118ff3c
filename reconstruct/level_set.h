#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "reconstruct/lme_lattice.h"
#include "reconstruct/point_cloud.h"

namespace umtet {

/// Coefficients psi_a, in model units, of the max-ent functions of one lattice: a term of the level set.
struct LevelSetLevel {
  Lattice lattice;
  std::vector<double> coefficients;  ///< lattice.size() values, x fastest; a LevelSet keeps kPad zeros behind them

  static constexpr std::size_t kPad = 8;  ///< eight-lane loads reach past the last node
};

/// psi(x) = sum over levels of sum_a psi_a N_a(x), negative inside: C2 on its domain, and satisfies the mesher's
/// ImplicitFunction.
///
/// The functions N_a are >= 0 and sum to one, so on a lattice cell psi lies between the least and the greatest sum of
/// coefficients of its support: sign bounds that list, rigorously, every cell where the surface can be.
/// All const members are thread-safe and do not allocate, but for sign_change_cells().
class LevelSet {
 public:
  /// @param levels  coarse to fine; the domain is the hull of the first
  /// \throw std::invalid_argument  no level, sizes that do not match, a lattice below 2 half_width nodes on an axis
  LevelSet(const LmePrior& prior, std::vector<LevelSetLevel> levels);

  double value(const Vec3& x) const;
  Vec3 gradient(const Vec3& x) const;
  Mat3 hessian(const Vec3& x) const;
  /// psi(x); its gradient and Hessian where the pointers are not null. Outside the domain psi continues with the value
  /// at the closest point of the domain plus the distance to it: positive far from the body, and without a new zero
  /// there.
  double evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const;

  /// Where psi is defined: the hull of the coarsest lattice's nodes.
  const Eigen::AlignedBox3d& domain() const { return domain_; }
  /// Lattice spacing of the finest level, model units.
  double spacing() const { return levels_.back().lattice.h; }
  const LmePrior& prior() const { return tables_->prior(); }
  const std::vector<LevelSetLevel>& levels() const { return levels_; }

  /// Least and greatest value psi can take in cell (i, j, k) of the finest lattice, from the coefficients alone.
  struct Bounds {
    double low, high;
  };
  Bounds cell_bounds(const Eigen::Vector3i& cell) const;
  /// Centres of the finest lattice's cells whose bounds have both signs: every zero of psi lies in one of these cells.
  std::vector<Vec3> sign_change_cells() const;

 private:
  std::shared_ptr<const LmeTables> tables_;
  std::vector<LevelSetLevel> levels_;
  Eigen::AlignedBox3d domain_;
};

}  // namespace umtet
