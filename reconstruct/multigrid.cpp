#include "reconstruct/multigrid.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "reconstruct/solve_error.h"
#include "reconstruct/ssd_assembled.h"

namespace umtet {

namespace {

constexpr std::ptrdiff_t kChunk = 1 << 14;

// f(begin, end) over fixed chunks of [0, n).
template <class F>
void for_chunks(std::ptrdiff_t n, F&& f) {
  const std::ptrdiff_t chunks = (n + kChunk - 1) / kChunk;
  tbb::parallel_for(std::ptrdiff_t{0}, chunks, [&](std::ptrdiff_t c) { f(c * kChunk, std::min(n, (c + 1) * kChunk)); });
}

// Summed by chunk, chunks in order: the same bits for any number of threads.
double dot(std::ptrdiff_t n, const double* a, const double* b) {
  std::vector<double> partial((n + kChunk - 1) / kChunk);
  for_chunks(n, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    double sum = 0;
    for (std::ptrdiff_t i = begin; i < end; ++i) sum += a[i] * b[i];
    partial[begin / kChunk] = sum;
  });
  double sum = 0;
  for (const double p : partial) sum += p;
  return sum;
}

// Cubes in which samples are merged, in spacings: half a spacing keeps PCG at 10 iterations to 1e-5 (a whole one
// doubles them).
constexpr double kMergeCube = 0.5;

// y (+)= P x along one axis of an array with `stride` between neighbours on the axis and `inner` contiguous columns.
void prolong_axis(const AxisProlongation& P, const double* x, std::ptrdiff_t inner, std::ptrdiff_t outer, double* y) {
  tbb::parallel_for(std::ptrdiff_t{0}, outer, [&](std::ptrdiff_t o) {
    for (int i = 0; i < P.n_fine; ++i) {
      double* out = y + (o * P.n_fine + i) * inner;
      std::fill(out, out + inner, 0.0);
      for (int a = 0; a < P.width; ++a) {
        const double w = P.weight[static_cast<std::size_t>(i) * P.width + a];
        if (w == 0) continue;
        const double* in = x + (o * P.n_coarse + P.first[i] + a) * inner;
        for (std::ptrdiff_t q = 0; q < inner; ++q) out[q] += w * in[q];
      }
    }
  });
}

void restrict_axis(const AxisProlongation& P, const double* x, std::ptrdiff_t inner, std::ptrdiff_t outer, double* y) {
  tbb::parallel_for(std::ptrdiff_t{0}, outer, [&](std::ptrdiff_t o) {
    double* out = y + o * P.n_coarse * inner;
    std::fill(out, out + P.n_coarse * inner, 0.0);
    for (int i = 0; i < P.n_fine; ++i) {
      const double* in = x + (o * P.n_fine + i) * inner;
      for (int a = 0; a < P.width; ++a) {
        const double w = P.weight[static_cast<std::size_t>(i) * P.width + a];
        if (w == 0) continue;
        double* to = out + (P.first[i] + a) * inner;
        for (std::ptrdiff_t q = 0; q < inner; ++q) to[q] += w * in[q];
      }
    }
  });
}

// Eigenvalues of D^-1 A in [lambda_max / kSmoothingRange, lambda_max] are damped by the smoother. The range is wide
// because coefficients that alternate in sign give almost no function: high frequencies, small eigenvalues. On a torus
// with 10 samples a cell, degrees 2 to 6 and ranges 30 to 200 all cost the same time within 20 %.
constexpr double kSmoothingRange = 60;
constexpr int kSmoothingDegree = 3;

}  // namespace

AxisProlongation::AxisProlongation(const LmePrior& prior, int coarse)
    : n_coarse(coarse), n_fine(2 * coarse - 1), width(2 * half_width(prior)) {
  LmePrior wide = prior;
  wide.gamma = 4 * prior.gamma / 3;
  for (int i = 0; i < n_fine; ++i) {
    const LmeBasis1d B = evaluate_lme_1d(wide, n_coarse, i / 2.0);
    first.push_back(B.first);
    weight.insert(weight.end(), B.N, B.N + width);
  }
}

Multigrid::Multigrid(const SsdOperator& finest, int n_levels) {
  Eigen::Vector3i n = finest.n();
  double kappa = finest.kappa();
  std::vector<SsdSample> samples = finest.samples();
  for (int l = 0; l < n_levels; ++l) {
    // Coarse coefficients keep the units of the finest ones; only the coordinate is halved: derivatives lose a factor 2
    // each, and the volume element gains 8: w_v stays, w_g becomes w_g / 4, kappa becomes kappa 8 / 16.
    const bool coarser = l > 0;
    if (coarser) {
      n = (n.array() - 1) / 2 + 1;
      kappa /= 2;
    }
    if (coarser) {
      for (SsdSample& s : samples) {
        s.xi /= 2;
        s.w_gradient /= 4;
      }
    }
    std::vector<SsdSample> means = merge_samples(samples, kMergeCube);
    if (coarser || means.size() < samples.size() / 2) samples = std::move(means);
    Level level{SsdOperator(finest.tables(), n, kappa, samples), {}, 0, {}, {}, {}, {}, {}};
    levels_.push_back(std::move(level));
  }
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    Level& level = levels_[l];
    const std::size_t size = level.op.size();
    for (auto* v : {&level.x, &level.r, &level.d, &level.Ad}) v->assign(size + SsdOperator::kPad, 0.0);
    if (l + 1 == levels_.size()) break;
    for (int d = 0; d < 3; ++d) level.up.emplace_back(finest.tables().prior(), levels_[l + 1].op.n()[d]);
    level.inverse_diagonal.resize(size);
    level.op.diagonal(level.inverse_diagonal.data());
    for (double& v : level.inverse_diagonal) v = 1 / v;
    // Power iteration from a fixed, rough vector; 20 steps come within some percent from below (12 do not where the energy dominates), hence the factor.
    for (std::size_t i = 0; i < size; ++i) level.x[i] = static_cast<double>((i * 2654435761u) % 2048) / 1024 - 1;
    for (int it = 0; it < 20; ++it) {
      const double norm = std::sqrt(dot(size, level.x.data(), level.x.data()));
      for (std::size_t i = 0; i < size; ++i) level.x[i] /= norm;
      level.op.apply(level.x.data(), level.Ad.data(), workspace_);
      for (std::size_t i = 0; i < size; ++i) level.x[i] = level.Ad[i] * level.inverse_diagonal[i];
    }
    level.lambda_max = 1.15 * std::sqrt(dot(size, level.x.data(), level.x.data()));
  }
  coarsest_.compute(Eigen::MatrixXd(assemble(levels_.back().op)));
  if (coarsest_.info() != Eigen::Success) {
    throw SolveError(fmt::format("the coarsest lattice ({} nodes) gives a matrix that is not positive definite",
                                 levels_.back().op.size()));
  }
}

// Chebyshev iteration for A x = r on D^-1 A; leaves the residual in level.r.
void Multigrid::smooth(Level& level, bool from_zero) {
  const std::ptrdiff_t n = level.op.size();
  const double high = level.lambda_max, low = high / kSmoothingRange;
  const double theta = (high + low) / 2, delta = (high - low) / 2, sigma = theta / delta;
  double rho = 1 / sigma;
  const double* D = level.inverse_diagonal.data();
  double *x = level.x.data(), *r = level.r.data(), *d = level.d.data(), *Ad = level.Ad.data();
  for_chunks(n, [&](std::ptrdiff_t b, std::ptrdiff_t e) {
    for (std::ptrdiff_t i = b; i < e; ++i) {
      d[i] = D[i] * r[i] / theta;
      x[i] = from_zero ? d[i] : x[i] + d[i];
    }
  });
  for (int step = 1;; ++step) {
    level.op.apply(d, Ad, workspace_);
    const double next = 1 / (2 * sigma - rho);
    const bool last = step == kSmoothingDegree;
    for_chunks(n, [&](std::ptrdiff_t b, std::ptrdiff_t e) {
      for (std::ptrdiff_t i = b; i < e; ++i) {
        r[i] -= Ad[i];
        if (last) continue;
        d[i] = next * rho * d[i] + 2 * next / delta * D[i] * r[i];
        x[i] += d[i];
      }
    });
    if (last) return;
    rho = next;
  }
}

void Multigrid::cycle(std::size_t l) {
  Level& level = levels_[l];
  if (l + 1 == levels_.size()) {
    const Eigen::Map<const Eigen::VectorXd> r(level.r.data(), level.op.size());
    Eigen::Map<Eigen::VectorXd>(level.x.data(), level.op.size()) = coarsest_.solve(r);
    return;
  }
  smooth(level, true);
  Level& coarse = levels_[l + 1];
  const std::ptrdiff_t fx = level.op.n()[0], fy = level.op.n()[1], fz = level.op.n()[2];
  const std::ptrdiff_t cy = coarse.op.n()[1], cz = coarse.op.n()[2];
  transfer_.resize(std::max<std::size_t>(transfer_.size(), fx * fy * cz + fx * cy * cz));
  double *half = transfer_.data(), *quarter = half + fx * fy * cz;
  restrict_axis(level.up[2], level.r.data(), fx * fy, 1, half);
  restrict_axis(level.up[1], half, fx, cz, quarter);
  restrict_axis(level.up[0], quarter, 1, cy * cz, coarse.r.data());
  cycle(l + 1);
  transfer_.resize(std::max<std::size_t>(transfer_.size(), fx * fy * cz + fx * cy * cz));
  half = transfer_.data(), quarter = half + fx * fy * cz;
  prolong_axis(level.up[0], coarse.x.data(), 1, cy * cz, quarter);
  prolong_axis(level.up[1], quarter, fx, cz, half);
  prolong_axis(level.up[2], half, fx * fy, 1, level.d.data());
  level.op.apply(level.d.data(), level.Ad.data(), workspace_);
  for_chunks(fx * fy * fz, [&](std::ptrdiff_t b, std::ptrdiff_t e) {
    for (std::ptrdiff_t i = b; i < e; ++i) {
      level.x[i] += level.d[i];
      level.r[i] -= level.Ad[i];
    }
  });
  smooth(level, false);
}

void Multigrid::apply(const double* r, double* z) {
  Level& level = levels_.front();
  std::copy(r, r + level.op.size(), level.r.begin());
  cycle(0);
  std::copy(level.x.begin(), level.x.begin() + level.op.size(), z);
}

PcgReport solve_pcg(const SsdOperator& A, Multigrid& M, const std::vector<double>& b, double tolerance,
                    int max_iterations, std::vector<double>& c, const std::function<void(double)>& progress) {
  const std::ptrdiff_t n = A.size();
  const std::size_t padded = n + SsdOperator::kPad;
  std::vector<double> r(b), z(padded, 0.0), p(padded, 0.0), Ap(padded, 0.0), workspace;
  r.resize(padded, 0.0);
  c.assign(padded, 0.0);
  PcgReport report;
  report.residuals.push_back(1);
  const double r0 = std::sqrt(dot(n, r.data(), r.data()));
  double rz = 0;
  report.converged = r0 == 0;
  while (!report.converged && report.iterations < max_iterations) {
    M.apply(r.data(), z.data());
    const double rz_next = dot(n, r.data(), z.data());
    const double beta = report.iterations ? rz_next / rz : 0;
    rz = rz_next;
    for_chunks(n, [&](std::ptrdiff_t first, std::ptrdiff_t last) {
      for (std::ptrdiff_t i = first; i < last; ++i) p[i] = z[i] + beta * p[i];
    });
    A.apply(p.data(), Ap.data(), workspace);
    const double alpha = rz / dot(n, p.data(), Ap.data());
    for_chunks(n, [&](std::ptrdiff_t first, std::ptrdiff_t last) {
      for (std::ptrdiff_t i = first; i < last; ++i) {
        c[i] += alpha * p[i];
        r[i] -= alpha * Ap[i];
      }
    });
    ++report.iterations;
    report.residuals.push_back(std::sqrt(dot(n, r.data(), r.data())) / r0);
    report.converged = report.residuals.back() <= tolerance;
    if (progress) progress(report.residuals.back());
  }
  return report;
}

}  // namespace umtet
