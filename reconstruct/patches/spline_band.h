#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "common/vec3.h"

namespace umtet {

/// Uniform tricubic B-splines on the cubes of a lattice that are near some samples [DeBoor1978].
///
///     f(x) = sum_k c_k B(x_1 / H - k_1) B(x_2 / H - k_2) B(x_3 / H - k_3)
///
/// They reproduce all polynomials of degree three in each coordinate, and are C2. Immutable; thread-safe.
class SplineBand {
 public:
  static constexpr int kNodes = 64;  ///< functions that are not zero in a cell

  /// @param points  samples; @param H  side of the cells; @param rings  of cells around those with samples
  SplineBand(const std::vector<Vec3>& points, double H, int rings);

  int n_nodes() const { return n_nodes_; }
  int n_cells() const { return static_cast<int>(cells_.size()); }
  /// The functions that are not zero in a cell, the first coordinate fastest.
  const std::array<int, kNodes>& nodes(int cell) const { return cells_[cell].nodes; }
  Vec3 centre(int cell) const;
  /// The cell of a point; -1 outside of the band.
  int cell_of(const Vec3& x) const;

  /// The functions of a cell at a point of it: a column each for the value and the three first derivatives.
  using Functions = Eigen::Matrix<double, kNodes, 4>;
  void functions(int cell, const Vec3& x, Functions& B) const;

  /// f at a point of a cell; derivatives where the pointers are not null.
  double evaluate(const std::vector<double>& c, int cell, const Vec3& x, Vec3* gradient, Mat3* hessian) const;

  /// The matrix of the energy of derivatives of one order, over one cell:
  ///
  ///     int sum over i, j, k with i + j + k = order of order! / (i! j! k!) (d^order f / dx^i dy^j dz^k)^2 dV
  Eigen::MatrixXd energy(int order) const;

 private:
  struct Cell {
    std::array<int, 3> at;
    std::array<int, kNodes> nodes;
  };
  static std::int64_t key(const std::array<int, 3>& at);
  std::array<int, 3> lattice_cell(const Vec3& x) const;
  std::array<double, 3> local(const Cell& cell, const Vec3& x) const;

  double H_;
  int n_nodes_ = 0;
  std::vector<Cell> cells_;
  std::unordered_map<std::int64_t, int> cell_at_;
};

}  // namespace umtet
