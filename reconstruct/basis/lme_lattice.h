#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <memory>
#include <vector>

#include "reconstruct/basis/lme_prior.h"
#include "reconstruct/basis/simd_packs.h"

namespace umtet {

/// Values of the max-ent functions of one axis at one point, for the nodes first, first + 1, ... Lanes without a node
/// are zero, so that loops may run over all eight.
struct alignas(32) LmeBasis1d {
  static constexpr int kPackSize = 8;
  double N[kPackSize], dN[kPackSize], ddN[kPackSize];  ///< functions and derivatives with respect to x / h
  int first = 0;
};

/// The lattice functions N_a(x) = p_i(x) p_j(y) p_k(z) at one point. A Gaussian prior and its compact relative are
/// products over the axes, and so is Z. The three-dimensional max-ent functions are therefore tensor products, also at
/// the hull.
struct LmeBasis3d {
  LmeBasis1d x, y, z;
};

/// Position of a point among the nodes of the three axes, with elements x, y, z and an unused one.
struct LmePlace {
  simd::Pack4i cell, piece, first;  ///< cell of the axis; piece of the tables; first node with a nonzero function there
  simd::Pack4d s;                   ///< position in the piece, 0 .. 1
};

/// Evaluates one-dimensional local max-ent functions on the nodes 0, 1, ..., n - 1 (unit spacing), by Newton's method
/// on log Z.
///
/// p_a = w_a e^{lambda d_a} / Z with d_a = x - a and lambda from sum p_a d_a = 0. With W_a = e^{lambda d_a} / Z:
///   p'  = W w' + p e,                e_a = lambda' d_a - <w'/w>,  lambda' = -(1 + sum W w' d) / J,  J = sum p d^2
///   p'' = T - p (sum T + d sum T d / J),   T = W w'' + 2 W w' e + p e^2
/// which needs no quotient w'/w and is therefore valid up to the edge of the support.     [ArroyoOrtiz2006, Section 3]
///
/// @param x  in [0, n - 1]; at the two ends the limit from inside is used
/// @param n  >= 2 half_width(prior)
LmeBasis1d evaluate_lme_1d(const LmePrior& prior, int n, double x);

/// Tabulated max-ent functions of a lattice. In a lattice cell they depend only on the numbers of nodes to the left and
/// to the right of it, up to the support. Each table holds quintic Hermite pieces of (N, N', N''), so tabulated
/// functions are C2, sum to one and reproduce x exactly, like the originals. For CompactC2 only (a cut Gaussian jumps
/// inside a cell).
class LmeTables {
 public:
  explicit LmeTables(const LmePrior& prior);
  const LmePrior& prior() const { return prior_; }
  int half_width() const { return R_; }
  int width() const { return 2 * R_; }

  /// N, N' and (if Second) N'' at x in [0, n - 1] on an axis of n >= width() nodes. Cost: about 10 ns.
  template <bool Second>
  void evaluate(int n, double x, LmeBasis1d& out) const {
    LmeBasis3d B;
    evaluate_3d<Second ? 2 : 1>({n, n, n}, {x, x, x}, 1, B);
    out = B.x;
  }
  /// Three axes at once; derivatives up to `order` with respect to x / scale. scale = 1 / h gives derivatives in model
  /// units.
  template <int order>
  void evaluate_3d(const Eigen::Vector3i& n, const Eigen::Vector3d& xi, double scale, LmeBasis3d& out) const {
    evaluate_at<order>(locate(n, xi), n, xi, scale, out);
  }
  /// The two steps of evaluate_3d(). Finding the place is a long chain of short operations; several points side by side
  /// cost little more than one.
  LmePlace locate(const Eigen::Vector3i& n, const Eigen::Vector3d& xi) const;
  template <int order>
  void evaluate_at(const LmePlace& place, const Eigen::Vector3i& n, const Eigen::Vector3d& xi, double scale,
                   LmeBasis3d& out) const;

 private:
  using Lanes = Eigen::Array<double, LmeBasis1d::kPackSize, 1>;
  struct Piece {
    Lanes c[6];  // N(s) = sum c_m s^m on a subinterval, s in [0, 1]
  };
  const Piece* table(int nodes_left, int nodes_right) const {
    return pieces_.data() + first_piece(nodes_left, nodes_right);
  }
  template <int order>
  [[gnu::always_inline]] static void evaluate_piece(const Piece& piece, double s, double scale, LmeBasis1d& out);
  void evaluate_exactly(const Eigen::Vector3i& n, const Eigen::Vector3d& xi, double scale, LmeBasis3d& out) const;
  void move_inside(const LmePlace& place, LmeBasis3d& out) const;

  // 256 pieces per cell: N'' has an error of 2e-9 (gamma = 1.2, R = 3), N of rounding.
  static constexpr int kPieces = 256;
  template <class Int>
  static Int first_piece(Int nodes_left, Int nodes_right) {
    return (nodes_left * 4 + nodes_right) * kPieces;  // at most four of each
  }
  LmePrior prior_;
  int R_;
  std::vector<Piece> pieces_;  // empty for a Gaussian prior
};

template <int order>
inline void LmeTables::evaluate_piece(const Piece& piece, double s, double scale, LmeBasis1d& out) {
  // Horner's scheme for the value also evaluates the derivatives.
  const Lanes* c = piece.c;
  Lanes N = c[5] * s + c[4], dN = c[5], ddN = c[5];
  for (int m = 3; m >= 0; --m) {
    if constexpr (order > 1) ddN = m == 3 ? dN : ddN * s + dN;
    if constexpr (order > 0) dN = dN * s + N;
    N = N * s + c[m];
  }
  using Out = Eigen::Map<Lanes, Eigen::Aligned32>;
  Out(out.N) = N;
  if constexpr (order > 0) Out(out.dN) = dN * scale;
  if constexpr (order > 1) Out(out.ddN) = ddN * (2 * scale * scale);
}

inline LmePlace LmeTables::locate(const Eigen::Vector3i& n, const Eigen::Vector3d& xi) const {
  using namespace simd;
  const Pack4i last = Pack4i{n[0], n[1], n[2], n[2]} - 2, zero = {}, inner = zero + (R_ - 1);
  const Pack4d x = {xi[0], xi[1], xi[2], xi[2]};
  const Pack4i cell = most(least(truncated(x), last), zero);
  const Pack4i left = least(cell, inner), right = least(last - cell, inner);
  const Pack4d t = (x - as_doubles(cell)) * double(kPieces);
  const Pack4i k = most(least(truncated(t), zero + (kPieces - 1)), zero);
  return {cell, first_piece(left, right) + k, most(least(cell - inner, last + 2 - width()), zero), t - as_doubles(k)};
}

template <int order>
inline void LmeTables::evaluate_at(const LmePlace& place, const Eigen::Vector3i& n, const Eigen::Vector3d& xi,
                                   double scale, LmeBasis3d& out) const {
  if (pieces_.empty()) return evaluate_exactly(n, xi, scale, out);
  scale *= kPieces;
  evaluate_piece<order>(pieces_[place.piece[0]], place.s[0], scale, out.x);
  evaluate_piece<order>(pieces_[place.piece[1]], place.s[1], scale, out.y);
  evaluate_piece<order>(pieces_[place.piece[2]], place.s[2], scale, out.z);
  out.x.first = place.first[0], out.y.first = place.first[1], out.z.first = place.first[2];
  const simd::Pack4i moved = place.first - place.cell + (R_ - 1);
  if (moved[0] | moved[1] | moved[2]) move_inside(place, out);
}

/// Cubic lattice: node (i, j, k) is at origin + h (i, j, k), with index i + n_x (j + n_y k).
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

/// Evaluates the lattice functions at a point. @param xi  (x - origin) / h, inside [0, n - 1] on each axis
template <bool Second>
void evaluate_lme_3d(const LmeTables& tables, const Eigen::Vector3i& n, const Eigen::Vector3d& xi, LmeBasis3d& out) {
  tables.evaluate_3d<Second ? 2 : 1>(n, xi, 1, out);
}

}  // namespace umtet
