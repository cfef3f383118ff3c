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

/// Coefficients psi_a, in model units, of all max-ent functions of a lattice.
struct LevelSetLevel {
  Lattice lattice;
  std::vector<double> coefficients;  ///< lattice.size() values, x fastest
};

/// Coefficients of a finer lattice in a narrow band around the surface, in model units. Nodes outside the blocks, and
/// nodes inside that no sample needs, have no coefficients.
///
/// Single precision suffices: a band represents the residual of the coarser levels, a hundredth of its spacing and
/// less. Sums are computed in double, so psi is as smooth as its functions.
struct LevelSetBand {
  LatticeBlocks blocks;
  std::vector<float> coefficients;  ///< LatticeBlocks::kNodes per block
};

/// Copies n^3 coefficients of a lattice, beginning at node `first`, to `out`, x fastest, with zero where there is no
/// node. Returns false if no node exists.
bool copy_window(const LevelSetLevel& level, const Eigen::Vector3i& first, int n, double* out);

/// Coefficients of the nodes in a box of a lattice. The coefficient of node (i, j, k), counted from the first node, is
/// first[i + row * j + layer * k].
template <class T>
struct CoefficientWindow {
  const T* first;
  std::ptrdiff_t row, layer;
};

/// Level set function psi(x) = sum over levels of sum_a psi_a N_a(x), negative inside. It is C2 on its domain and
/// satisfies the mesher's ImplicitFunction. The first level is a full lattice. Each of the others is a correction in a
/// band around the surface, on a lattice of half the spacing that contains the coarser one's nodes.
///
/// Copies share their coefficients. All const members are thread-safe. Only band_limited() and, in bands, the first
/// evaluation in a block of 8 x 8 x 8 cells allocate memory.
class LevelSet {
 public:
  /// @param bands  coarse to fine, with spacings of 1/2, 1/4, 1/8, ... of the coarsest lattice's
  /// \throw std::invalid_argument for sizes or lattices that do not match, or less than 2 half_width nodes on an axis
  LevelSet(const LmePrior& prior, LevelSetLevel coarsest, std::vector<LevelSetBand> bands = {});

  /// The sum with an additional level.
  LevelSet with_band(LevelSetBand band) const;
  /// psi without the levels of a smaller spacing (the coarsest level always stays).
  LevelSet band_limited(double spacing) const;

  /// Frees the caches that evaluations have built for levels of a smaller spacing, three times the size of their
  /// coefficients. Later evaluations rebuild them. No thread may evaluate this level set, or a copy of it, during the
  /// call.
  void forget_below(double spacing) const;

  double value(const Vec3& x) const;
  Vec3 gradient(const Vec3& x) const;
  Mat3 hessian(const Vec3& x) const;
  /// Value of psi at x, with gradient and Hessian if the pointers are not null. Outside the domain, psi is continued by
  /// the value at the closest point of the domain plus the distance to it. It is therefore positive far from the body,
  /// and has no new zero there.
  double evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const { return evaluate(x, false, gradient, hessian); }
  /// Value of one term of the sum, inside the domain; level 0 is the coarsest.
  double evaluate_level(int level, const Vec3& x, Vec3* gradient, Mat3* hessian) const;

  /// Domain of psi: the bounding box of the coarsest lattice's nodes.
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

  /// Coefficients of the functions that are nonzero in a cell of the coarsest lattice, 2 half_width along each axis.
  CoefficientWindow<double> coarsest_window(const Eigen::Vector3i& cell) const;
  /// The same coefficients for a band; `first` is null if the band has no coefficients there.
  /// @param level  1 .. n_levels() - 1
  CoefficientWindow<float> band_window(int level, const Eigen::Vector3i& cell) const;

 private:
  // For evaluation, each block of 8 x 8 x 8 cells has a copy of all coefficients that are used in it, so no gathering
  // is needed. It is made at the first evaluation in the block: a mesh evaluates only the levels that its h can
  // resolve, near psi = 0.
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
  // `apart`: no copy is made for an isolated position.
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

/// A view of a level set for positions that are far apart, such as those of a coarse grid. Values are the same to the
/// bit, but no caches are built. The level set must outlive it.
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
