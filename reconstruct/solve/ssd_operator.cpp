#include "reconstruct/solve/ssd_operator.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "common/first_touch.h"
#include "reconstruct/basis/contract.h"
#include "reconstruct/solve/detail/sample_basis.h"

namespace umtet {

namespace {

using namespace detail;
using namespace simd;

// Slabs of L cell layers run in parallel with every other one, and must never write to the node layers of one another.
// A sample in cell layer z writes to layers z - R + 1 .. z + R, and its eight-lane stores may spill (adding zero) into
// the next. A slab that begins at z therefore stays apart from the one that ends at z - L if L > 2R - 1; at the upper
// hull, where windows are moved down to begin at n_z - 2R while z may be as high as n_z - 2, if L > 3R - 2. R is at
// most 4.
constexpr int kSlabLayers = 12;
static_assert(kSlabLayers > 3 * 4 - 2);

// y += q N + g . grad N, the transpose of contract.
template <int W>
void scatter(const LmeBasis3d& B, const Eigen::Vector3i& n, double q, const Eigen::Vector3d& g, double* y) {
  const std::ptrdiff_t nx = n[0], nxy = nx * n[1];
  double* base = y + B.x.first + nx * B.y.first + nxy * B.z.first;
  const LmePackMap N(B.x.N), dN(B.x.dN);
  const LmePack v = q * N + g[0] * dN, vy = g[1] * N, vz = g[2] * N;
  for (int j = 0; j < W; ++j) {
    const LmePack a = B.y.N[j] * v + B.y.dN[j] * vy, az = B.y.N[j] * vz;
    for (int k = 0; k < W; ++k) {
      double* row = base + j * nx + k * nxy;
      Eigen::Map<LmePack>(row) += B.z.N[k] * a + B.z.dN[k] * az;
    }
  }
}

}  // namespace

SsdOperator::SsdOperator(const LmeTables& tables, const Eigen::Vector3i& n, double kappa,
                         std::vector<SsdSample> samples)
    : tables_(&tables), n_(n), kappa_(kappa), energy_(tables, n), samples_(std::move(samples)) {
  const auto key = [&](const SsdSample& s) {
    const std::int64_t z = std::min<std::int64_t>(s.xi[2], n_[2] - 2), y = std::min<std::int64_t>(s.xi[1], n_[1] - 2),
                       x = std::min<std::int64_t>(s.xi[0], n_[0] - 2);
    return (z * n_[1] + y) * n_[0] + x;
  };
  // Sorted by (cell, position in the input): one order, whatever the sorting threads do.
  std::vector<std::pair<std::int64_t, std::uint32_t>> order(samples_.size());
  tbb::parallel_for(std::size_t{0}, order.size(), [&](std::size_t i) {
    order[i] = {key(samples_[i]), static_cast<std::uint32_t>(i)};
  });
  tbb::parallel_sort(order.begin(), order.end());
  std::vector<SsdSample> sorted = touched<SsdSample>(order.size());
  tbb::parallel_for(std::size_t{0}, order.size(), [&](std::size_t row) { sorted[row] = samples_[order[row].second]; });
  samples_ = std::move(sorted);
  const int n_slabs = (n_[2] - 1 + kSlabLayers - 1) / kSlabLayers;
  slab_begin_.assign(n_slabs + 1, samples_.size());
  slab_begin_[0] = 0;
  for (std::size_t i = samples_.size(); i-- > 0;) {
    const int slab = std::min(static_cast<int>(samples_[i].xi[2]), n_[2] - 2) / kSlabLayers;
    for (int s = slab; s >= 0 && slab_begin_[s] > i; --s) slab_begin_[s] = i;
  }
}

// Slabs of one parity at a time: no two threads write to one node, and each node sees its samples in a fixed order.
template <class PerSample>
void SsdOperator::for_each_slab(PerSample&& f) const {
  const int n_slabs = static_cast<int>(slab_begin_.size()) - 1;
  for (int parity = 0; parity < 2; ++parity) {
    tbb::parallel_for(0, (n_slabs - parity + 1) / 2, [&](int s) {
      const int slab = 2 * s + parity;
      for (std::size_t i = slab_begin_[slab]; i < slab_begin_[slab + 1]; ++i) f(i, slab);
    });
  }
}

void SsdOperator::apply(const double* c, double* y, std::vector<double>& workspace) const {
  energy_.apply(kappa_, c, y, workspace);
  dispatch_width(tables_->width(), [&](auto W) {
    for_each_slab([&](std::size_t i, int) {
      const SsdSample& s = samples_[i];
      LmeBasis3d B;
      evaluate_lme_3d<false>(*tables_, n_, s.xi, B);
      const LatticeJet f = contract<W.value, kGradient>(B, n_, c);
      scatter<W.value>(B, n_, s.w_value * f.value, s.w_gradient * f.gradient, y);
    });
  });
}

void SsdOperator::tabulate() {
  dispatch_width(tables_->width(), [&](auto W) {
    using Basis = SampleBasis<W.value>;
    bases_ = std::make_unique_for_overwrite<float[]>(samples_.size() * Basis::kStride);
    first_.resize(samples_.size());
    tbb::parallel_for(std::size_t{0}, samples_.size(), [&](std::size_t i) {
      LmeBasis3d B;
      evaluate_lme_3d<false>(*tables_, n_, samples_[i].xi, B);
      Basis::store(B, samples_[i], bases_.get() + i * Basis::kStride);
      first_[i] =
          B.x.first + static_cast<std::ptrdiff_t>(n_[0]) * (B.y.first + static_cast<std::ptrdiff_t>(n_[1]) * B.z.first);
    });
  });
}

void SsdOperator::apply(const float* c, float* y, std::vector<float>& workspace) const {
  energy_.apply(kappa_, c, y, workspace);
  const std::ptrdiff_t nx = n_[0], nxy = nx * n_[1];
  dispatch_width(tables_->width(), [&](auto W) {
    using Basis = SampleBasis<W.value>;
    for_each_slab([&](std::size_t i, int) {
      add_sample(Basis{bases_.get() + i * Basis::kStride}, c + first_[i], y + first_[i], nx, nxy);
    });
  });
}

void SsdOperator::right_hand_side(double* y) const {
  std::fill(y, y + size(), 0.0);
  dispatch_width(tables_->width(), [&](auto W) {
    for_each_slab([&](std::size_t i, int) {
      const SsdSample& s = samples_[i];
      LmeBasis3d B;
      evaluate_lme_3d<false>(*tables_, n_, s.xi, B);
      scatter<W.value>(B, n_, s.w_value * s.value, s.w_gradient * s.normal, y);
    });
  });
}

void SsdOperator::diagonal(double* y) const {
  std::fill(y, y + size(), 0.0);
  energy_.add_diagonal(kappa_, y);
  const int W = tables_->width();
  for_each_slab([&](std::size_t i, int) {
    const SsdSample& s = samples_[i];
    LmeBasis3d B;
    evaluate_lme_3d<false>(*tables_, n_, s.xi, B);
    const std::ptrdiff_t nx = n_[0], nxy = nx * n_[1];
    double* base = y + B.x.first + nx * B.y.first + nxy * B.z.first;
    for (int k = 0; k < W; ++k) {
      for (int j = 0; j < W; ++j) {
        const double yz = B.y.N[j] * B.z.N[k], dyz = B.y.dN[j] * B.z.N[k], ydz = B.y.N[j] * B.z.dN[k];
        for (int i = 0; i < W; ++i) {
          const double N2 = B.x.N[i] * B.x.N[i], d2 = B.x.dN[i] * B.x.dN[i];
          base[i + j * nx + k * nxy] +=
              s.w_value * N2 * yz * yz + s.w_gradient * (d2 * yz * yz + N2 * (dyz * dyz + ydz * ydz));
        }
      }
    }
  });
}

Eigen::Vector3d SsdOperator::energies(const double* c, std::vector<double>& workspace) const {
  std::vector<Eigen::Vector2d> slab_sum(slab_begin_.size(), Eigen::Vector2d::Zero());
  dispatch_width(tables_->width(), [&](auto W) {
    for_each_slab([&](std::size_t i, int slab) {
      const SsdSample& s = samples_[i];
      LmeBasis3d B;
      evaluate_lme_3d<false>(*tables_, n_, s.xi, B);
      const LatticeJet f = contract<W.value, kGradient>(B, n_, c);
      slab_sum[slab] += Eigen::Vector2d(s.w_value * std::pow(f.value - s.value, 2),
                                        s.w_gradient * (f.gradient - s.normal).squaredNorm()) /
                        2;
    });
  });
  Eigen::Vector3d e = Eigen::Vector3d::Zero();
  for (const Eigen::Vector2d& s : slab_sum) e.head<2>() += s;
  std::vector<double> Kc(size());
  energy_.apply(kappa_, c, Kc.data(), workspace);
  for (std::ptrdiff_t a = 0; a < size(); ++a) e[2] += c[a] * Kc[a] / 2;
  return e;
}

}  // namespace umtet
