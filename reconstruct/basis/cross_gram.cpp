#include "reconstruct/basis/cross_gram.h"

#include <boost/math/quadrature/gauss.hpp>

namespace umtet {

CrossGram::CrossGram(const LmeTables& tables, int k)
    : k_(k),
      reach_(tables.half_width() * (1 + (1 << k)) - 1),
      shift_(tables.half_width() - 1),
      m_(2 * reach_ + 1),
      s_(m_.size()),
      b_(m_.size()) {
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
  constexpr int kEdge = LatticeBlocks::kEdge;
  axes_.resize(std::max(1, ratio / kEdge));
  for (int block = 0; block < static_cast<int>(axes_.size()); ++block) {
    const int first = kEdge * block - shift_, begin = window_begin(Eigen::Vector3i::Constant(first))[0];
    for (int j = 0; j < window_size(); ++j)
      for (int i = 0; i < kEdge; ++i) {
        const int d = first + i - ((begin + j) << k_);
        axes_[block].m[j][i] = static_cast<float>(this->m(d));
        axes_[block].s[j][i] = static_cast<float>(this->s(d));
        axes_[block].b[j][i] = static_cast<float>(this->b(d));
      }
  }
}

Eigen::Vector3i CrossGram::window_begin(const Eigen::Vector3i& first) const {
  // ceil((first - reach) / 2^k): an arithmetic shift rounds down for negative numbers, too.
  return first.unaryExpr([&](int i) { return (i - reach_ + (1 << k_) - 1) >> k_; });
}

void CrossGram::add_energy(const Eigen::Vector3i& first, const float* C, float* out) const {
  constexpr int kEdge = LatticeBlocks::kEdge;
  using Lanes = Axis::Lanes;
  const int n = window_size();
  const Axis &X = axis(first[0]), &Y = axis(first[1]), &Z = axis(first[2]);
  // x and y plane by plane; along z the planes A, B and D go with m, b and s.
  Lanes M[Axis::kMostWindow], S[Axis::kMostWindow], B[Axis::kMostWindow];
  for (int z = 0; z < n; ++z) {
    for (int y = 0; y < n; ++y) {
      const float* row = C + (static_cast<std::ptrdiff_t>(z) * n + y) * n;
      Lanes m = Lanes::Zero(), s = m, b = m;
      for (int x = 0; x < n; ++x) m += row[x] * X.m[x], s += row[x] * X.s[x], b += row[x] * X.b[x];
      M[y] = m, S[y] = s, B[y] = b;
    }
    for (int j = 0; j < kEdge; ++j) {
      Lanes with_m = Lanes::Zero(), with_b = with_m, with_s = with_m;
      for (int y = 0; y < n; ++y) {
        const float my = Y.m[y][j], sy = Y.s[y][j], by = Y.b[y][j];
        with_m += my * B[y] + by * M[y] + (2 * sy) * S[y];
        with_b += my * M[y];
        with_s += (2 * my) * S[y] + (2 * sy) * M[y];
      }
      for (int i = 0; i < kEdge; ++i) {
        Eigen::Map<Lanes>(out + (i * kEdge + j) * kEdge) +=
            Z.m[z][i] * with_m + Z.b[z][i] * with_b + Z.s[z][i] * with_s;
      }
    }
  }
}

}  // namespace umtet
