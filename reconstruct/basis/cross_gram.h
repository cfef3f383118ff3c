#pragma once

#include <vector>

#include "reconstruct/basis/lattice_blocks.h"
#include "reconstruct/basis/lme_lattice.h"

namespace umtet {

/// Gram matrices of one axis between a lattice of spacing 1 and one of spacing 2^k with common nodes. Away from the
/// walls both sets of functions are translates, and an entry depends on d = i - 2^k j only:
///   m = int N(x - i) N(x / 2^k - j) dx,  s and b the same with first and second derivatives in x.
/// k = 0 gives the middle rows of AxisGram.
class CrossGram {
 public:
  CrossGram(const LmeTables& tables, int k);

  double m(int d) const { return at(m_, d); }
  double s(int d) const { return at(s_, d); }
  double b(int d) const { return at(b_, d); }
  /// Entries can be nonzero for |d| <= reach().
  int reach() const { return reach_; }

  /// Returns the first coarse node on each axis whose function overlaps a function of the fine nodes first .. first +
  /// 7.
  /// @param first  first node of a block of LatticeBlocks: 1 - half_width plus a multiple of 8
  Eigen::Vector3i window_begin(const Eigen::Vector3i& first) const;
  /// The number of these coarse nodes on an axis.
  int window_size() const { return (LatticeBlocks::kEdge - 1 + 2 * reach_) / (1 << k_) + 1; }

  /// out_a += int H(N_a) : H(sum_b C_b N_b) dV in units of the finer lattice, for the 8 x 8 x 8 nodes a of a block that
  /// begins at fine node `first`, as products of the three axes, like HessianEnergy. Single precision, as the
  /// coefficients of a band.
  /// @param C  window_size()^3 coefficients of the coarser lattice, beginning at window_begin(first), x fastest
  void add_energy(const Eigen::Vector3i& first, const float* C, float* out) const;

 private:
  // Entries between the eight fine nodes of a block along an axis and each coarse node of its window.
  struct Axis {
    static constexpr int kMostWindow = 32;
    using Lanes = Eigen::Array<float, LatticeBlocks::kEdge, 1>;
    Lanes m[kMostWindow], s[kMostWindow], b[kMostWindow];
  };
  const Axis& axis(int first) const { return axes_[(first + shift_) / LatticeBlocks::kEdge & (axes_.size() - 1)]; }
  double at(const std::vector<double>& a, int d) const { return d < -reach_ || d > reach_ ? 0 : a[d + reach_]; }
  int k_, reach_, shift_;
  std::vector<double> m_, s_, b_;  // entry d at d + reach_
  std::vector<Axis> axes_;         // one per position of a block relative to a coarse cell: 2^k / 8, or one
};

}  // namespace umtet
