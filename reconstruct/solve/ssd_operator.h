#pragma once

#include <memory>
#include <vector>

#include "reconstruct/basis/gram.h"
#include "reconstruct/basis/lme_lattice.h"
#include "reconstruct/solve/ssd_sample.h"

namespace umtet {

/// Matrix-free operator and right-hand side of eq. (11) on one lattice:
///   A = kappa K + Σ_i ( w_v N N^T + w_g ∇N·∇N^T ),   r = Σ_i ( w_g ∇N · n_i + w_v N v_i ),   N_a = N_a(x_i).
/// Coefficients are in units of the lattice spacing: f = h Σ c_a N_a.                     [Rangarajan2018, eqs. (10),
/// (11)]
class SsdOperator {
 public:
  /// @param samples  inside the lattice hull; sorted into slabs of cells for locality and threads
  SsdOperator(const LmeTables& tables, const Eigen::Vector3i& n, double kappa, std::vector<SsdSample> samples);

  const Eigen::Vector3i& n() const { return n_; }
  std::ptrdiff_t size() const { return static_cast<std::ptrdiff_t>(n_[0]) * n_[1] * n_[2]; }
  double kappa() const { return kappa_; }
  const HessianEnergy& energy() const { return energy_; }
  const LmeTables& tables() const { return *tables_; }
  const std::vector<SsdSample>& samples() const { return samples_; }

  /// y = A c. `c` and `y` have size() + kPad doubles (vector loads and stores may extend beyond the last node).
  void apply(const double* c, double* y, std::vector<double>& workspace) const;
  /// Stores the functions at the samples in single precision, about 180 bytes per sample.
  void tabulate();
  /// y = A c in single precision, in half the time. Arrays have the same sizes. \pre tabulate()
  void apply(const float* c, float* y, std::vector<float>& workspace) const;
  /// y = diag(A)
  void diagonal(double* y) const;
  /// y = r; y has size() + kPad doubles
  void right_hand_side(double* y) const;
  /// The three terms of the functional at c, in lattice units: ½ Σ w_v (f − v)², ½ Σ w_g |∇f − n|², ½ kappa cᵀ K c.
  Eigen::Vector3d energies(const double* c, std::vector<double>& workspace) const;

  static constexpr int kPad = 8;

 private:
  template <class PerSample>
  void for_each_slab(PerSample&& f) const;

  const LmeTables* tables_;
  Eigen::Vector3i n_;
  double kappa_;
  HessianEnergy energy_;
  std::vector<SsdSample> samples_;
  std::vector<std::size_t> slab_begin_;  // samples of slab s: slab_begin_[s] .. slab_begin_[s + 1]
  std::unique_ptr<float[]> bases_;       // by tabulate(): detail::SampleBasis of each sample,
  std::vector<std::ptrdiff_t> first_;    // and its first node
};

}  // namespace umtet
