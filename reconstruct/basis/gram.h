#pragma once

#include <vector>

#include "reconstruct/basis/lme_lattice.h"

namespace umtet {

/// Symmetric banded matrix of one axis. Row i holds columns i - half .. i + half; entries outside the axis are zero.
template <class T>
struct BandMatrixOf {
  int n = 0, half = 0;
  std::vector<T> a;         ///< n rows of 2 half + 1 entries
  std::vector<T> diagonal;  ///< the same by diagonals, for vectors of rows: entry (i, i + o) is at (o + half) n + i

  T operator()(int i, int j) const { return a[static_cast<std::size_t>(i) * (2 * half + 1) + (j - i + half)]; }
  const T* row(int i) const { return a.data() + static_cast<std::size_t>(i) * (2 * half + 1); }
};
using BandMatrix = BandMatrixOf<double>;

/// The Gram matrices of one axis in lattice units: m = int N N, s = int N' N', b = int N'' N''; 8-point Gauss in each
/// cell (relative error of b below 1e-3 at gamma = 1.6, smaller for wider functions).
template <class T>
struct AxisGramOf {
  BandMatrixOf<T> m, s, b;
};
using AxisGram = AxisGramOf<double>;
AxisGram axis_gram(const LmeTables& tables, int n);

/// Matrix-free Hessian energy int H(f) : H(f) dV over the hull of a lattice, in lattice units. It is the sum of tensor
/// products
///   b x m x m + m x b x m + m x m x b + 2 (s x s x m + s x m x s + m x s x s).
/// In model units int H:H = h times this, for coefficients in units of h.        [Rangarajan2018, eq. (10), third term]
class HessianEnergy {
 public:
  HessianEnergy(const LmeTables& tables, const Eigen::Vector3i& n);

  /// y = kappa K c, for arrays of n_x n_y n_z numbers. Planes run in parallel; the bits do not depend on the number of
  /// threads. `workspace` grows to three arrays of that size. Single precision takes half the time.
  void apply(double kappa, const double* c, double* y, std::vector<double>& workspace) const;
  void apply(double kappa, const float* c, float* y, std::vector<float>& workspace) const;
  /// y += kappa diag(K)
  void add_diagonal(double kappa, double* y) const;
  /// One entry of K.
  double entry(const Eigen::Vector3i& a, const Eigen::Vector3i& b) const;
  const AxisGram& axis(int d) const { return axes_[d]; }

 private:
  Eigen::Vector3i n_;
  AxisGram axes_[3];
  AxisGramOf<float> single_[3];  // axes_ rounded to single precision
};

}  // namespace umtet
