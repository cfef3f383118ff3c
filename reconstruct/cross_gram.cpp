#include "reconstruct/cross_gram.h"

#include <boost/math/quadrature/gauss.hpp>

namespace umtet {

CrossGram::CrossGram(const LmeTables& tables, int k)
    : k_(k), reach_(tables.half_width() * (1 + (1 << k)) - 1), m_(2 * reach_ + 1), s_(m_.size()), b_(m_.size()) {
  const int R = tables.half_width(), ratio = 1 << k;
  const int n = 4 * R + 1, centre = 2 * R;  // an axis whose middle cells are away from its ends
  using Gauss = boost::math::quadrature::gauss<double, 8>;
  // The coarse function of node 0 against the fine functions, fine cell by fine cell.
  for (int cell = -R * ratio; cell < R * ratio; ++cell) {
    for (std::size_t q = 0; q < Gauss::abscissa().size(); ++q) {
      for (const double side : {-1.0, 1.0}) {
        const double t = 0.5 + 0.5 * side * Gauss::abscissa()[q], weight = 0.5 * Gauss::weights()[q];
        LmeBasis1d fine, coarse;
        tables.evaluate<true>(n, centre + t, fine);
        tables.evaluate<true>(n, centre + (cell + t) / ratio, coarse);
        const int lane = centre - coarse.first;
        if (lane < 0 || lane >= tables.width()) continue;
        const double N = weight * coarse.N[lane], dN = weight * coarse.dN[lane] / ratio,
                     ddN = weight * coarse.ddN[lane] / (ratio * ratio);
        for (int a = 0; a < tables.width(); ++a) {
          const int d = cell + fine.first + a - centre;
          if (d < -reach_ || d > reach_) continue;  // functions that only touch
          m_[d + reach_] += N * fine.N[a];
          s_[d + reach_] += dN * fine.dN[a];
          b_[d + reach_] += ddN * fine.ddN[a];
        }
      }
    }
  }
}

Eigen::Vector3i CrossGram::window_begin(const Eigen::Vector3i& first) const {
  // ceil((first - reach) / 2^k): an arithmetic shift rounds down for negative numbers, too.
  return first.unaryExpr([&](int i) { return (i - reach_ + (1 << k_) - 1) >> k_; });
}

void CrossGram::add_energy(const Eigen::Vector3i& first, const double* C, double* out) const {
  constexpr int kEdge = LatticeBlocks::kEdge, kMostWindow = 32;
  using Lanes = Eigen::Array<double, kEdge, 1>;
  const int n = window_size();
  const Eigen::Vector3i begin = window_begin(first);
  // Entries between the eight fine nodes of an axis and each coarse node of the window.
  Lanes m[3][kMostWindow], s[3][kMostWindow], b[3][kMostWindow];
  for (int axis = 0; axis < 3; ++axis)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < kEdge; ++i) {
        const int d = first[axis] + i - ((begin[axis] + j) << k_);
        m[axis][j][i] = this->m(d), s[axis][j][i] = this->s(d), b[axis][j][i] = this->b(d);
      }
  // x and y plane by plane; along z the planes A, B and D go with m, b and s.
  Lanes M[kMostWindow], S[kMostWindow], B[kMostWindow];
  Eigen::Map<Eigen::Array<double, kEdge, kEdge * kEdge>> sum(out);
  for (int z = 0; z < n; ++z) {
    for (int y = 0; y < n; ++y) {
      const double* row = C + (static_cast<std::ptrdiff_t>(z) * n + y) * n;
      M[y].setZero(), S[y].setZero(), B[y].setZero();
      for (int x = 0; x < n; ++x) M[y] += row[x] * m[0][x], S[y] += row[x] * s[0][x], B[y] += row[x] * b[0][x];
    }
    for (int j = 0; j < kEdge; ++j) {
      Lanes with_m = Lanes::Zero(), with_b = with_m, with_s = with_m;
      for (int y = 0; y < n; ++y) {
        const double my = m[1][y][j], sy = s[1][y][j], by = b[1][y][j];
        with_m += my * B[y] + by * M[y] + (2 * sy) * S[y];
        with_b += my * M[y];
        with_s += (2 * my) * S[y] + (2 * sy) * M[y];
      }
      for (int i = 0; i < kEdge; ++i)
        sum.col(i * kEdge + j) += m[2][z][i] * with_m + b[2][z][i] * with_b + s[2][z][i] * with_s;
    }
  }
}

}  // namespace umtet
