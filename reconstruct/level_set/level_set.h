#pragma once

#include <Eigen/Geometry>
#include <atomic>
#include <memory>
#include <vector>

#include "common/vec3.h"
#include "reconstruct/basis/lattice_blocks.h"
#include "reconstruct/basis/lme_lattice.h"

namespace umtet {

namespace simd {
struct LatticeJet;
}

/// Coefficients psi_a, in model units, of all max-ent functions of one lattice.
struct LevelSetLevel {
  Lattice lattice;
  std::vector<double> coefficients;  ///< lattice.size() values, x fastest
};

/// Coefficients of a finer lattice near the surface, in model units: its nodes outside the blocks, and those inside
/// that no sample needs, have none.
///
/// Single precision: a band holds what the coarser levels leave over, a hundredth of its spacing and less. Sums are
/// made in double, so psi is as smooth as its functions.
struct LevelSetBand {
  LatticeBlocks blocks;
  std::vector<float> coefficients;  ///< LatticeBlocks::kNodes a block
};

/// Copies n^3 coefficients of a lattice from node `first` on to `out`, x fastest, zero where there is no node; false if
/// there is none at all.
bool copy_window(const LevelSetLevel& level, const Eigen::Vector3i& first, int n, double* out);

/// Coefficients of the nodes of a box of a lattice: that of node (i, j, k), from the first one on, is
/// first[i + row * j + layer * k].
template <class T>
struct CoefficientWindow {
  const T* first;
  std::ptrdiff_t row, layer;
};

/// psi(x) = sum over levels of sum_a psi_a N_a(x), negative inside: C2 on its domain, and satisfies the mesher's
/// ImplicitFunction. The first level is a full lattice; each of the others is a correction in a band around the
/// surface, on a lattice of half the spacing that shares the coarser one's nodes.
///
/// Copies share their coefficients. All const members are thread-safe. None allocates but band_limited() and, in bands,
/// the first evaluation in a block of 8 x 8 x 8 cells.
class LevelSet {
 public:
  /// @param bands  coarse to fine, each as fine as 2, 4, 8, ... times the coarsest lattice
  /// \throw std::invalid_argument  sizes or lattices that do not match, or below 2 half_width nodes on an axis
  LevelSet(const LmePrior& prior, LevelSetLevel coarsest, std::vector<LevelSetBand> bands = {});

  /// The sum with one more level.
  LevelSet with_band(LevelSetBand band) const;
  /// psi down to a spacing: without the levels that are finer (the coarsest always stays).
  LevelSet band_limited(double spacing) const;

  /// Frees what evaluations have made of the levels of a smaller spacing, which is three times their coefficients; the
  /// next ones make it again. Nobody may evaluate this level set, or a copy of it, meanwhile.
  void forget_below(double spacing) const;

  double value(const Vec3& x) const;
  Vec3 gradient(const Vec3& x) const;
  Mat3 hessian(const Vec3& x) const;
  /// psi(x); its gradient and Hessian where the pointers are not null. Outside the domain psi continues with the value
  /// at the closest point of the domain plus the distance to it: positive far from the body, and without a new zero
  /// there.
  double evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const { return evaluate(x, false, gradient, hessian); }
  /// The same of one term of the sum, inside the domain: level 0 is the coarsest.
  double evaluate_level(int level, const Vec3& x, Vec3* gradient, Mat3* hessian) const;

  /// Where psi is defined: the hull of the coarsest lattice's nodes.
  const Eigen::AlignedBox3d& domain() const { return domain_; }
  int n_levels() const { return 1 + static_cast<int>(bands_.size()); }
  const Lattice& lattice(int level) const {
    return level == 0 ? coarsest_->lattice : bands_[level - 1]->data.blocks.lattice();
  }
  /// Lattice spacing of the finest level, model units.
  double spacing() const { return lattice(n_levels() - 1).h; }
  const LmeTables& tables() const { return *tables_; }
  const LmePrior& prior() const { return tables_->prior(); }
  const LevelSetLevel& coarsest() const { return *coarsest_; }
  /// @param level  1 .. n_levels() - 1
  const LevelSetBand& band(int level) const { return bands_[level - 1]->data; }

  /// The coefficients of the functions that count in a cell of the coarsest lattice, 2 half_width along each axis.
  CoefficientWindow<double> coarsest_window(const Eigen::Vector3i& cell) const;
  /// The same in a band; `first` is null where it has none. @param level  1 .. n_levels() - 1
  CoefficientWindow<float> band_window(int level, const Eigen::Vector3i& cell) const;

 private:
  // For evaluation each block of 8 x 8 x 8 cells has a copy of all coefficients that count in it: no gathering. It is
  // made when someone first evaluates there: a mesh reads the levels that its h can show, near psi = 0.
  struct Band {
    LevelSetBand data;
    Eigen::Vector3i n;                                       // cell blocks along each axis
    int edge;                                                // nodes along the edge of a window, 8 + 2R - 1
    mutable std::vector<std::atomic<const float*>> windows;  // of cell blocks, edge^3 each; null: all zero

    Band(LevelSetBand&& band, int half_width);
    Band(const Band&) = delete;
    Band& operator=(const Band&) = delete;
    ~Band();
    void forget() const;
    std::size_t index(const simd::Pack4i& block) const;
    bool has(const simd::Pack4i& block) const;
    const float* window(const simd::Pack4i& block) const;
    const float* make_window(std::size_t index) const;
  };
  friend class LevelSetApart;
  // Of a place that is apart from others no copy is made.
  double evaluate(const Vec3& x, bool apart, Vec3* gradient, Mat3* hessian) const;
  // The sum of the levels first .. end - 1.
  simd::LatticeJet sum_levels(const Vec3& x, int first, int end, bool apart, Vec3* gradient, Mat3* hessian) const;
  template <int W, int order, bool apart>
  simd::LatticeJet sum_levels(const Vec3& x, int first, int end) const;

  std::shared_ptr<const LmeTables> tables_;
  std::shared_ptr<const LevelSetLevel> coarsest_;
  std::vector<std::shared_ptr<const Band>> bands_;
  Eigen::AlignedBox3d domain_;
};

/// A level set for places that are far apart, such as those of a coarse grid: the same numbers to the bit, and it makes
/// and keeps nothing for others beside them. The level set must outlive it.
class LevelSetApart {
 public:
  explicit LevelSetApart(const LevelSet& psi) : psi_(psi) {}
  double evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const {
    return psi_.evaluate(x, true, gradient, hessian);
  }
  double value(const Vec3& x) const { return evaluate(x, nullptr, nullptr); }

 private:
  const LevelSet& psi_;
};

}  // namespace umtet
