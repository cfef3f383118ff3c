#include "reconstruct/basis/gram.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>

namespace umtet {

AxisGram axis_gram(const LmeTables& tables, int n) {
  const int half = tables.width() - 1;
  AxisGram g;
  for (BandMatrix* M : {&g.m, &g.s, &g.b}) {
    M->n = n, M->half = half;
    M->a.assign(static_cast<std::size_t>(n) * (2 * half + 1), 0.0);
  }
  using Gauss = boost::math::quadrature::gauss<double, 8>;
  for (int cell = 0; cell + 1 < n; ++cell) {
    for (std::size_t q = 0; q < Gauss::abscissa().size(); ++q) {
      for (const double side : {-1.0, 1.0}) {
        LmeBasis1d B;
        tables.evaluate<true>(n, cell + 0.5 + 0.5 * side * Gauss::abscissa()[q], B);
        const double w = 0.5 * Gauss::weights()[q];
        for (int i = 0; i < tables.width(); ++i) {
          for (int j = 0; j < tables.width(); ++j) {
            const std::size_t at = static_cast<std::size_t>(B.first + i) * (2 * half + 1) + (j - i + half);
            g.m.a[at] += w * B.N[i] * B.N[j];
            g.s.a[at] += w * B.dN[i] * B.dN[j];
            g.b.a[at] += w * B.ddN[i] * B.ddN[j];
          }
        }
      }
    }
  }
  for (BandMatrix* M : {&g.m, &g.s, &g.b}) {
    const std::size_t width = 2 * half + 1;
    M->diagonal.resize(M->a.size());
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i)
      for (std::size_t o = 0; o < width; ++o) M->diagonal[o * n + i] = M->a[i * width + o];
  }
  return g;
}

namespace {

BandMatrixOf<float> rounded(const BandMatrix& M) {
  return {M.n, M.half, {M.a.begin(), M.a.end()}, {M.diagonal.begin(), M.diagonal.end()}};
}

}  // namespace

HessianEnergy::HessianEnergy(const LmeTables& tables, const Eigen::Vector3i& n) : n_(n) {
  for (int d = 0; d < 3; ++d) {
    axes_[d] = axis_gram(tables, n[d]);
    single_[d] = {rounded(axes_[d].m), rounded(axes_[d].s), rounded(axes_[d].b)};
  }
}

namespace {

// Rows are worked on in chunks whose accumulators stay in registers; the last chunk of a row overlaps the one before it
// (every output is a function of the inputs alone), so that no row needs a scalar tail.
template <int Chunk, class F>
void for_row_chunks(int n, F&& f) {
  for (int i = 0; i < n; i += Chunk) f(std::min(i, n - Chunk));
}

template <class T, int Chunk>
using Lanes = Eigen::Array<T, Chunk, 1>;
template <class T, int Chunk>
using In = Eigen::Map<const Lanes<T, Chunk>>;
template <class T, int Chunk>
using Out = Eigen::Map<Lanes<T, Chunk>>;

// m c, s c and b c along a row. Away from the ends all rows of a band matrix are one symmetric stencil; near them each
// lane has its own.
// @param c  with `half` zeros before the first and after the last
template <int Chunk, class T>
void apply_along_x(const AxisGramOf<T>& g, const T* c, T* mc, T* sc, T* bc) {
  const int n = g.m.n, w = g.m.half, edge = 2 * w + 1;
  const T *m = g.m.row(n / 2) + w, *s = g.s.row(n / 2) + w, *b = g.b.row(n / 2) + w;
  for_row_chunks<Chunk>(n, [&](int start) {
    const T* at = c + start;
    Lanes<T, Chunk> M, S, B;
    if (start >= edge && start + Chunk <= n - edge) {
      const Lanes<T, Chunk> centre = In<T, Chunk>(at);
      M = m[0] * centre, S = s[0] * centre, B = b[0] * centre;
      for (int o = 1; o <= w; ++o) {
        const Lanes<T, Chunk> pair = In<T, Chunk>(at - o) + In<T, Chunk>(at + o);
        M += m[o] * pair, S += s[o] * pair, B += b[o] * pair;
      }
    } else {
      M.setZero(), S.setZero(), B.setZero();
      for (int o = 0; o <= 2 * w; ++o) {
        const Lanes<T, Chunk> x = In<T, Chunk>(at + o - w);
        const std::size_t entry = static_cast<std::size_t>(o) * n + start;
        M += In<T, Chunk>(g.m.diagonal.data() + entry) * x;
        S += In<T, Chunk>(g.s.diagonal.data() + entry) * x;
        B += In<T, Chunk>(g.b.diagonal.data() + entry) * x;
      }
    }
    Out<T, Chunk>(mc + start) = M;
    Out<T, Chunk>(sc + start) = S;
    Out<T, Chunk>(bc + start) = B;
  });
}

template <class T>
struct PlaneWork {
  std::vector<T> rows;    // m c, s c and b c along x of one plane
  std::vector<T> padded;  // a row of c between zeros
};

// One plane of the three arrays that are still to be combined along z: A goes with m, B with b, C with s.
template <int Chunk, class T>
void combine_xy(const AxisGramOf<T>& gx, const AxisGramOf<T>& gy, const T* c, PlaneWork<T>& work, T* A, T* B, T* C) {
  const int nx = gx.m.n, ny = gy.m.n, w = gy.m.half;
  const std::size_t plane = static_cast<std::size_t>(nx) * ny;
  work.rows.resize(3 * plane);
  T *mx = work.rows.data(), *sx = mx + plane, *bx = sx + plane;
  work.padded.assign(nx + 2 * gx.m.half, 0);
  T* row = work.padded.data() + gx.m.half;
  for (int j = 0; j < ny; ++j) {
    const std::size_t at = static_cast<std::size_t>(j) * nx;
    std::copy(c + at, c + at + nx, row);
    apply_along_x<Chunk>(gx, row, mx + at, sx + at, bx + at);
  }
  for (int j = 0; j < ny; ++j) {
    const T *m = gy.m.row(j) + w - j, *s = gy.s.row(j) + w - j, *b = gy.b.row(j) + w - j;
    const int first = std::max(0, j - w), last = std::min(ny - 1, j + w);
    for_row_chunks<Chunk>(nx, [&](int start) {
      Lanes<T, Chunk> a = Lanes<T, Chunk>::Zero(), d = a, e = a;
      for (int q = first; q <= last; ++q) {
        const std::size_t at = static_cast<std::size_t>(q) * nx + start;
        const Lanes<T, Chunk> M = In<T, Chunk>(mx + at), S = In<T, Chunk>(sx + at);
        a += m[q] * In<T, Chunk>(bx + at) + b[q] * M + (2 * s[q]) * S;
        d += m[q] * M;
        e += m[q] * S + s[q] * M;
      }
      const std::size_t at = static_cast<std::size_t>(j) * nx + start;
      Out<T, Chunk>(A + at) = a;
      Out<T, Chunk>(B + at) = d;
      Out<T, Chunk>(C + at) = 2 * e;
    });
  }
}

template <int Chunk, class T>
void apply_energy(const AxisGramOf<T>* axes, const Eigen::Vector3i& n, T kappa, const T* c, T* y,
                  std::vector<T>& workspace) {
  const int nx = n[0], ny = n[1], nz = n[2];
  const std::size_t plane = static_cast<std::size_t>(nx) * ny, size = plane * nz;
  if (workspace.size() < 3 * size) workspace.resize(3 * size);  // shared by all levels: grows only
  T *A = workspace.data(), *B = A + size, *C = B + size;
  tbb::parallel_for(0, nz, [&](int k) {
    thread_local PlaneWork<T> work;
    combine_xy<Chunk>(axes[0], axes[1], c + k * plane, work, A + k * plane, B + k * plane, C + k * plane);
  });
  const AxisGramOf<T>& g = axes[2];
  const int w = g.m.half;
  tbb::parallel_for(0, nz, [&](int k) {
    const T *m = g.m.row(k) + w - k, *s = g.s.row(k) + w - k, *b = g.b.row(k) + w - k;
    const int first = std::max(0, k - w), last = std::min(nz - 1, k + w);
    for (int j = 0; j < ny; ++j) {
      for_row_chunks<Chunk>(nx, [&](int start) {
        const std::size_t row = static_cast<std::size_t>(j) * nx + start;
        Lanes<T, Chunk> sum = Lanes<T, Chunk>::Zero();
        for (int q = first; q <= last; ++q) {
          const std::size_t at = q * plane + row;
          sum += m[q] * In<T, Chunk>(A + at) + b[q] * In<T, Chunk>(B + at) + s[q] * In<T, Chunk>(C + at);
        }
        Out<T, Chunk>(y + k * plane + row) = kappa * sum;
      });
    }
  });
}

}  // namespace

void HessianEnergy::apply(double kappa, const double* c, double* y, std::vector<double>& workspace) const {
  if (n_[0] >= 8)
    apply_energy<8>(axes_, n_, kappa, c, y, workspace);
  else
    apply_energy<2>(axes_, n_, kappa, c, y, workspace);
}

void HessianEnergy::apply(double kappa, const float* c, float* y, std::vector<float>& workspace) const {
  const auto k = static_cast<float>(kappa);
  if (n_[0] >= 16)
    apply_energy<16>(single_, n_, k, c, y, workspace);
  else if (n_[0] >= 8)
    apply_energy<8>(single_, n_, k, c, y, workspace);
  else
    apply_energy<2>(single_, n_, k, c, y, workspace);
}

double HessianEnergy::entry(const Eigen::Vector3i& p, const Eigen::Vector3i& q) const {
  double m[3], s[3], b[3];
  for (int d = 0; d < 3; ++d) {
    if (std::abs(p[d] - q[d]) > axes_[d].m.half) return 0;
    m[d] = axes_[d].m(p[d], q[d]), s[d] = axes_[d].s(p[d], q[d]), b[d] = axes_[d].b(p[d], q[d]);
  }
  return b[0] * m[1] * m[2] + m[0] * b[1] * m[2] + m[0] * m[1] * b[2] +
         2 * (s[0] * s[1] * m[2] + s[0] * m[1] * s[2] + m[0] * s[1] * s[2]);
}

void HessianEnergy::add_diagonal(double kappa, double* y) const {
  std::size_t at = 0;
  Eigen::Vector3i a;
  for (a[2] = 0; a[2] < n_[2]; ++a[2])
    for (a[1] = 0; a[1] < n_[1]; ++a[1])
      for (a[0] = 0; a[0] < n_[0]; ++a[0]) y[at++] += kappa * entry(a, a);
}

}  // namespace umtet
