#include "reconstruct/gram.h"

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
  return g;
}

HessianEnergy::HessianEnergy(const LmeTables& tables, const Eigen::Vector3i& n) : n_(n) {
  for (int d = 0; d < 3; ++d) axes_[d] = axis_gram(tables, n[d]);
}

namespace {

// Rows are worked on in chunks whose accumulators stay in registers; the last chunk of a row overlaps the one before it
// (every output is a function of the inputs alone), so that no row needs a scalar tail.
template <int Chunk, class F>
void for_row_chunks(int n, F&& f) {
  for (int i = 0; i < n; i += Chunk) f(std::min(i, n - Chunk));
}

template <int Chunk>
using Lanes = Eigen::Array<double, Chunk, 1>;
template <int Chunk>
using In = Eigen::Map<const Lanes<Chunk>>;
template <int Chunk>
using Out = Eigen::Map<Lanes<Chunk>>;

// m c, s c and b c along a contiguous row. Away from the ends all rows of a band matrix are one symmetric stencil.
template <int Chunk>
void apply_along_x(const AxisGram& g, const double* c, double* mc, double* sc, double* bc) {
  const int n = g.m.n, w = g.m.half, edge = 2 * w + 1;
  const auto general = [&](int i) {
    double m = 0, s = 0, b = 0;
    for (int j = std::max(0, i - w); j <= std::min(n - 1, i + w); ++j) {
      m += g.m(i, j) * c[j], s += g.s(i, j) * c[j], b += g.b(i, j) * c[j];
    }
    mc[i] = m, sc[i] = s, bc[i] = b;
  };
  if (n < 2 * edge + Chunk) {
    for (int i = 0; i < n; ++i) general(i);
    return;
  }
  for (int i = 0; i < edge; ++i) general(i), general(n - 1 - i);
  const double *m = g.m.row(edge) + w, *s = g.s.row(edge) + w, *b = g.b.row(edge) + w;
  for_row_chunks<Chunk>(n - 2 * edge, [&](int start) {
    const double* at = c + edge + start;
    const Lanes<Chunk> centre = In<Chunk>(at);
    Lanes<Chunk> M = m[0] * centre, S = s[0] * centre, B = b[0] * centre;
    for (int o = 1; o <= w; ++o) {
      const Lanes<Chunk> pair = In<Chunk>(at - o) + In<Chunk>(at + o);
      M += m[o] * pair, S += s[o] * pair, B += b[o] * pair;
    }
    Out<Chunk>(mc + edge + start) = M;
    Out<Chunk>(sc + edge + start) = S;
    Out<Chunk>(bc + edge + start) = B;
  });
}

struct PlaneWork {
  std::vector<double> rows;  // m c, s c and b c along x of one plane
};

// One plane of the three arrays that are still to be combined along z: A goes with m, B with b, C with s.
template <int Chunk>
void combine_xy(const AxisGram& gx, const AxisGram& gy, const double* c, PlaneWork& work, double* A, double* B,
                double* C) {
  const int nx = gx.m.n, ny = gy.m.n, w = gy.m.half;
  const std::size_t plane = static_cast<std::size_t>(nx) * ny;
  work.rows.resize(3 * plane);
  double *mx = work.rows.data(), *sx = mx + plane, *bx = sx + plane;
  for (int j = 0; j < ny; ++j) {
    const std::size_t at = static_cast<std::size_t>(j) * nx;
    apply_along_x<Chunk>(gx, c + at, mx + at, sx + at, bx + at);
  }
  for (int j = 0; j < ny; ++j) {
    const double *m = gy.m.row(j) + w - j, *s = gy.s.row(j) + w - j, *b = gy.b.row(j) + w - j;
    const int first = std::max(0, j - w), last = std::min(ny - 1, j + w);
    for_row_chunks<Chunk>(nx, [&](int start) {
      Lanes<Chunk> a = Lanes<Chunk>::Zero(), d = a, e = a;
      for (int q = first; q <= last; ++q) {
        const std::size_t at = static_cast<std::size_t>(q) * nx + start;
        const Lanes<Chunk> M = In<Chunk>(mx + at), S = In<Chunk>(sx + at);
        a += m[q] * In<Chunk>(bx + at) + b[q] * M + (2 * s[q]) * S;
        d += m[q] * M;
        e += (2 * m[q]) * S + (2 * s[q]) * M;
      }
      const std::size_t at = static_cast<std::size_t>(j) * nx + start;
      Out<Chunk>(A + at) = a;
      Out<Chunk>(B + at) = d;
      Out<Chunk>(C + at) = e;
    });
  }
}

template <int Chunk>
void apply_energy(const AxisGram* axes, const Eigen::Vector3i& n, double kappa, const double* c, double* y, double* A,
                  double* B, double* C) {
  const int nx = n[0], ny = n[1], nz = n[2];
  const std::size_t plane = static_cast<std::size_t>(nx) * ny;
  tbb::parallel_for(0, nz, [&](int k) {
    thread_local PlaneWork work;
    combine_xy<Chunk>(axes[0], axes[1], c + k * plane, work, A + k * plane, B + k * plane, C + k * plane);
  });
  const AxisGram& g = axes[2];
  const int w = g.m.half;
  tbb::parallel_for(0, nz, [&](int k) {
    const double *m = g.m.row(k) + w - k, *s = g.s.row(k) + w - k, *b = g.b.row(k) + w - k;
    const int first = std::max(0, k - w), last = std::min(nz - 1, k + w);
    for (int j = 0; j < ny; ++j) {
      for_row_chunks<Chunk>(nx, [&](int start) {
        const std::size_t row = static_cast<std::size_t>(j) * nx + start;
        Lanes<Chunk> sum = Lanes<Chunk>::Zero();
        for (int q = first; q <= last; ++q) {
          const std::size_t at = q * plane + row;
          sum += m[q] * In<Chunk>(A + at) + b[q] * In<Chunk>(B + at) + s[q] * In<Chunk>(C + at);
        }
        Out<Chunk>(y + k * plane + row) = kappa * sum;
      });
    }
  });
}

}  // namespace

void HessianEnergy::apply(double kappa, const double* c, double* y, std::vector<double>& workspace) const {
  const std::size_t size = static_cast<std::size_t>(n_[0]) * n_[1] * n_[2];
  if (workspace.size() < 3 * size) workspace.resize(3 * size);  // shared by all levels: grows only
  double *A = workspace.data(), *B = A + size, *C = B + size;
  if (n_[0] >= 8)
    apply_energy<8>(axes_, n_, kappa, c, y, A, B, C);
  else
    apply_energy<2>(axes_, n_, kappa, c, y, A, B, C);
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
