#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "reconstruct/lme_prior.h"

namespace umtet {

/// Values of the max-ent functions of one axis at one point: those of nodes first, first + 1, ... The lanes that no
/// node has are zero, so that loops may run over all eight.
struct alignas(32) LmeBasis1d {
  static constexpr int kLanes = 8;
  double N[kLanes], dN[kLanes], ddN[kLanes];  ///< functions and derivatives with respect to x / h
  int first = 0;
};

/// One-dimensional max-ent functions on the nodes 0, 1, ..., n - 1 (unit spacing), by Newton's method on log Z.
///
/// p_a = w_a e^{lambda d_a} / Z with d_a = x - a and lambda from sum p_a d_a = 0. With W_a = e^{lambda d_a} / Z:
///   p'  = W w' + p e,                e_a = lambda' d_a - <w'/w>,  lambda' = -(1 + sum W w' d) / J,  J = sum p d^2
///   p'' = T - p (sum T + d sum T d / J),   T = W w'' + 2 W w' e + p e^2
/// which needs no quotient w'/w and so holds up to the edge of the support.              [ArroyoOrtiz2006, Section 3]
///
/// @param x  in [0, n - 1]; at the two ends the limit from inside is taken
/// @param n  >= 2 half_width(prior)
LmeBasis1d evaluate_lme_1d(const LmePrior& prior, int n, double x);

/// The same functions from tables: in a lattice cell they depend only on how many nodes there are to the left and to
/// the right of it, up to the support. Each table holds quintic Hermite pieces of (N, N', N''), so tabulated functions
/// are C2, sum to one and reproduce x exactly as the originals do. Only for CompactC2 (a cut Gaussian jumps inside a
/// cell).
class LmeTables {
 public:
  explicit LmeTables(const LmePrior& prior);
  const LmePrior& prior() const { return prior_; }
  int half_width() const { return R_; }
  int width() const { return 2 * R_; }

  /// N, N' and (if Second) N'' at x in [0, n - 1] on an axis of n >= width() nodes. Cost: about 10 ns.
  template <bool Second>
  void evaluate(int n, double x, LmeBasis1d& out) const;

 private:
  using Lanes = Eigen::Array<double, LmeBasis1d::kLanes, 1>;
  struct Piece {
    Lanes c[6];  // N(s) = sum c_m s^m on a subinterval, s in [0, 1]
  };
  const Piece* table(int nodes_left, int nodes_right) const {
    return pieces_.data() + static_cast<std::size_t>(nodes_left * R_ + nodes_right) * kPieces;
  }

  // 256 pieces a cell: N'' is right to 2e-9 (gamma = 1.2, R = 3), N to rounding.
  static constexpr int kPieces = 256;
  LmePrior prior_;
  int R_;
  std::vector<Piece> pieces_;  // empty for a Gaussian prior
};

/// Nodes of a cubic lattice: node (i, j, k) at origin + h (i, j, k), index i + n_x (j + n_y k).
struct Lattice {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  double h = 1;
  Eigen::Vector3i n = Eigen::Vector3i::Zero();

  std::ptrdiff_t size() const { return static_cast<std::ptrdiff_t>(n[0]) * n[1] * n[2]; }
  std::ptrdiff_t index(int i, int j, int k) const {
    return i + static_cast<std::ptrdiff_t>(n[0]) * (j + static_cast<std::ptrdiff_t>(n[1]) * k);
  }
  bool operator==(const Lattice& o) const { return origin == o.origin && h == o.h && n == o.n; }
};

/// The lattice functions N_a(x) = p_i(x) p_j(y) p_k(z) at one point: a Gaussian prior and its compact relative are
/// products over the axes, and so is Z; the three-dimensional max-ent functions are therefore tensor products, hull
/// included.
struct LmeBasis3d {
  LmeBasis1d x, y, z;
};

/// @param xi  (x - origin) / h, inside [0, n - 1] on each axis
template <bool Second>
void evaluate_lme_3d(const LmeTables& tables, const Eigen::Vector3i& n, const Eigen::Vector3d& xi, LmeBasis3d& out) {
  tables.evaluate<Second>(n[0], xi[0], out.x);
  tables.evaluate<Second>(n[1], xi[1], out.y);
  tables.evaluate<Second>(n[2], xi[2], out.z);
}

}  // namespace umtet
