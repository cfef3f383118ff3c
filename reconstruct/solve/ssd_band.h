#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "reconstruct/basis/lattice_blocks.h"
#include "reconstruct/level_set/level_set.h"
#include "reconstruct/solve/ssd_operator.h"

namespace umtet {

/// The system of eq. (11) for a correction g on one level of the multilevel fit. The unknowns are the nodes whose
/// functions meet a sample, and the data are the residual of the sum f of the coarser levels:
///   A = kappa K + sum_s ( w_v N N^T + w_g grad N . grad N^T ),
///   r = sum_s ( w_g grad N . (n - grad f) + w_v N (v - f) ) - kappa int H(N) : H(f),    all in lattice units.
///
/// A is applied in single precision: PCG only has to reduce the residual by two or three digits on each level, and the
/// next level starts from the misfit of psi in double precision (only the sums of r are single). Each cell block works
/// on copies of its nodes. Blocks that share nodes have different colours, so that sums have one order for any number
/// of threads.
class SsdBand {
 public:
  /// @param samples  samples of the cells to refine, in block order (merge_samples()), lattice units; stored by
  ///                 reference
  SsdBand(const LmeTables& tables, const Lattice& lattice, double kappa, const std::vector<SsdSample>& samples);
  /// A part of a band: the system at some of its blocks, the own ones.
  /// @param samples  all samples in cells whose functions belong to an own block, in block order
  /// @param blocks   the own blocks and those next to them, where the band has them
  /// @param own      range of the own blocks: first, first + 1, ..., end - 1
  SsdBand(const LmeTables& tables, LatticeBlocks blocks, double kappa, const std::vector<SsdSample>& samples,
          std::array<int, 2> own);

  /// The blocks of a band for these samples.
  static std::vector<Eigen::Vector3i> blocks_of(const std::vector<SsdSample>& samples, int half_width);
  const LatticeBlocks& blocks() const { return blocks_; }
  /// Number of values of an array: LatticeBlocks::kNodes per block.
  std::size_t size() const { return static_cast<std::size_t>(blocks_.size()) * LatticeBlocks::kNodes; }
  /// Number of active nodes in own blocks.
  std::size_t n_active() const { return n_active_; }
  int first_own() const { return own_[0]; }
  int end_own() const { return own_[1]; }

  /// y = A p in own blocks. p has to be zero on nodes that are not active.
  void apply(const float* p, float* y) const;
  /// 1 / diag(A) on active nodes, and 0 on the others, so that a step along it does not move them.
  const std::vector<float>& inverse_diagonal() const { return inverse_diagonal_; }

  /// r in own blocks; zero on nodes that are not active, and in other blocks.
  /// @param f  the sum of the coarser levels
  void residual(const LevelSet& f, std::vector<float>& r) const;

  /// Memory in bytes that a band of these samples takes during the solve, estimated in advance: per block the vectors
  /// of the solve and the copies that are made afterwards for evaluating psi, per sample its functions.
  static double expected_bytes(const std::vector<SsdSample>& samples, int half_width);

 private:
  struct CellBlock {
    std::array<int, 8> nodes;      // blocks b and b + 1 of each axis, x fastest; -1: no active node there
    std::array<int, 8> own_nodes;  // the same; -1 also for blocks that are not own
    Eigen::Vector3i block;
    std::size_t begin, end;  // its samples
  };
  template <class F>
  void for_each_cell_block(F&& f) const;
  template <int W>
  void tabulate();
  template <int W>
  void apply_data(const float* p, float* y) const;
  template <int R>
  void apply_energy(const float* p, float* y) const;
  void subtract_energy(const LevelSet& f, std::vector<float>& r) const;
  template <int W>
  void add_misfit(const LevelSet& f, std::vector<float>& r) const;
  void invert_diagonal();

  const LmeTables* tables_;
  double kappa_;
  const std::vector<SsdSample>* samples_;
  LatticeBlocks blocks_;
  std::vector<CellBlock> cell_blocks_;
  std::array<int, 2> own_;
  std::array<std::vector<int>, 8> colours_;
  std::vector<std::array<int, 27>> neighbours_;
  std::unique_ptr<float[]> bases_;     // per sample: N, N' in x (8 lanes each), y and z (W each), weights
  std::vector<std::uint16_t> window_;  // first node of a sample in the 16^3 nodes of its cell block
  std::vector<float> inverse_diagonal_;
  std::size_t n_active_ = 0;
};

}  // namespace umtet
