#include "reconstruct/solve/multigrid.h"

#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "common/formatted.h"
#include "reconstruct/solve/solve_error.h"
#include "reconstruct/solve/ssd_assembled.h"

namespace umtet {

namespace {

// Values in a chunk: enough that a task costs nothing beside it.
constexpr std::ptrdiff_t kValuesInChunk = 1 << 14;

// f(begin, end) over fixed chunks of [0, n).
template <class F>
void for_chunks(std::ptrdiff_t n, F&& f) {
  const std::ptrdiff_t chunks = (n + kValuesInChunk - 1) / kValuesInChunk;
  tbb::parallel_for(std::ptrdiff_t{0}, chunks,
                    [&](std::ptrdiff_t c) { f(c * kValuesInChunk, std::min(n, (c + 1) * kValuesInChunk)); });
}

// Sum of term(i), by chunk, chunks in order: the same bits for any number of threads.
template <class F>
double sum_of(std::ptrdiff_t n, F&& term) {
  std::vector<double> partial((n + kValuesInChunk - 1) / kValuesInChunk);
  for_chunks(n, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    double sum = 0;
    for (std::ptrdiff_t i = begin; i < end; ++i) sum += term(i);
    partial[begin / kValuesInChunk] = sum;
  });
  double sum = 0;
  for (const double p : partial) sum += p;
  return sum;
}

double dot(std::ptrdiff_t n, const double* a, const double* b) {
  return sum_of(n, [&](std::ptrdiff_t i) { return a[i] * b[i]; });
}

// Cubes in which samples are merged for the preconditioner, in spacings. Larger ones make it too unlike the operator,
// and PCG takes more iterations; smaller ones merge little.
constexpr double kPreconditionerCube = 0.5;

// f(o, begin, end) for columns begin .. end - 1 of each of `outer` planes of `inner` columns.
template <class F>
void for_columns(std::ptrdiff_t inner, std::ptrdiff_t outer, F&& f) {
  constexpr std::ptrdiff_t kColumns = 1 << 9;  // of a task: some microseconds of each of its rows
  const std::ptrdiff_t parts = (inner + kColumns - 1) / kColumns;
  tbb::parallel_for(std::ptrdiff_t{0}, outer * parts, [&](std::ptrdiff_t task) {
    const std::ptrdiff_t begin = task % parts * kColumns;
    f(task / parts, begin, std::min(inner, begin + kColumns));
  });
}

// y = P x along one axis of an array with `stride` between neighbours on the axis and `inner` contiguous columns.
void prolong_axis(const AxisProlongation& P, const float* x, std::ptrdiff_t inner, std::ptrdiff_t outer, float* y) {
  for_columns(inner, outer, [&](std::ptrdiff_t o, std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (int i = 0; i < P.n_fine; ++i) {
      float* out = y + (o * P.n_fine + i) * inner;
      std::fill(out + begin, out + end, 0.f);
      for (int a = 0; a < P.width; ++a) {
        const float w = P.weight[static_cast<std::size_t>(i) * P.width + a];
        if (w == 0) continue;
        const float* in = x + (o * P.n_coarse + P.first[i] + a) * inner;
        for (std::ptrdiff_t q = begin; q < end; ++q) out[q] += w * in[q];
      }
    }
  });
}

void restrict_axis(const AxisProlongation& P, const float* x, std::ptrdiff_t inner, std::ptrdiff_t outer, float* y) {
  for_columns(inner, outer, [&](std::ptrdiff_t o, std::ptrdiff_t begin, std::ptrdiff_t end) {
    float* out = y + o * P.n_coarse * inner;
    for (int i = 0; i < P.n_coarse; ++i) std::fill(out + i * inner + begin, out + i * inner + end, 0.f);
    for (int i = 0; i < P.n_fine; ++i) {
      const float* in = x + (o * P.n_fine + i) * inner;
      for (int a = 0; a < P.width; ++a) {
        const float w = P.weight[static_cast<std::size_t>(i) * P.width + a];
        if (w == 0) continue;
        float* to = out + (P.first[i] + a) * inner;
        for (std::ptrdiff_t q = begin; q < end; ++q) to[q] += w * in[q];
      }
    }
  });
}

// Eigenvalues of D^-1 A in [lambda_max / kSmoothingRange, lambda_max] are damped by the smoother. The range is wide
// because coefficients that alternate in sign give almost no function: high frequencies, small eigenvalues. A wider
// range needs a higher degree; the time of a solve is flat around these values.
constexpr double kSmoothingRange = 60;
constexpr int kSmoothingDegree = 3;

// The largest eigenvalue of D^-1 A, by Lanczos' method in the scalar product of D from a fixed, rough vector. It comes
// from below: kSteps steps are within a per cent where the data dominate and where the energy does, hence kMargin.
// @param x, v, Av  room for size() + kPad numbers
double largest_eigenvalue(const SsdOperator& op, const std::vector<float>& inverse_diagonal, float* x, float* v,
                          float* Av, std::vector<float>& workspace) {
  constexpr int kSteps = 10;       // of Lanczos' method, which converges from below
  constexpr double kMargin = 1.1;  // covers what kSteps steps lack
  const std::ptrdiff_t n = op.size();
  const float* D = inverse_diagonal.data();
  for_chunks(n, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t i = begin; i < end; ++i) {
      x[i] = static_cast<float>((static_cast<std::size_t>(i) * 2654435761U) % 2048) / 1024 - 1;
      v[i] = 0;
    }
  });
  std::vector<double> alpha, beta;
  double b = 0;
  for (int step = 0; step < kSteps; ++step) {
    const double norm = std::sqrt(sum_of(n, [&](std::ptrdiff_t i) { return double(x[i]) * x[i] / D[i]; }));
    if (!(norm > 0)) break;
    if (step > 0) beta.push_back(b = norm);
    // v, x: the vector before, times -b, and this one
    for_chunks(n, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (std::ptrdiff_t i = begin; i < end; ++i) {
        const auto now = static_cast<float>(x[i] / norm);
        x[i] = static_cast<float>(-b * v[i]);
        v[i] = now;
      }
    });
    op.apply(v, Av, workspace);
    const double a = sum_of(n, [&](std::ptrdiff_t i) { return double(v[i]) * Av[i]; });
    alpha.push_back(a);
    for_chunks(n, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (std::ptrdiff_t i = begin; i < end; ++i) x[i] += D[i] * Av[i] - static_cast<float>(a) * v[i];
    });
  }
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> T;
  const Eigen::Map<const Eigen::VectorXd> diagonal(alpha.data(), static_cast<Eigen::Index>(alpha.size()));
  T.computeFromTridiagonal(diagonal, Eigen::Map<const Eigen::VectorXd>(beta.data(), diagonal.size() - 1),
                           Eigen::EigenvaluesOnly);
  return kMargin * T.eigenvalues().maxCoeff();
}

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
      tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t i) {
        samples[i].xi /= 2;
        samples[i].w_gradient /= 4;
      });
    }
    std::vector<SsdSample> means = merge_samples(samples, kPreconditionerCube);
    if (coarser || means.size() < samples.size() / 2) samples = std::move(means);
    Level level{SsdOperator(finest.tables(), n, kappa, samples), {}, 0, {}, {}, {}, {}, {}};
    levels_.push_back(std::move(level));
  }
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    Level& level = levels_[l];
    const std::size_t size = level.op.size();
    for (auto* v : {&level.x, &level.r, &level.d, &level.Ad}) v->assign(size + SsdOperator::kPad, 0.f);
    if (l + 1 == levels_.size()) break;
    level.op.tabulate();
    for (int d = 0; d < 3; ++d) level.up.emplace_back(finest.tables().prior(), levels_[l + 1].op.n()[d]);
    std::vector<double> diagonal(size);
    level.op.diagonal(diagonal.data());
    level.inverse_diagonal.resize(size);
    for_chunks(level.op.size(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (std::ptrdiff_t i = begin; i < end; ++i) level.inverse_diagonal[i] = static_cast<float>(1 / diagonal[i]);
    });
    level.lambda_max = largest_eigenvalue(level.op, level.inverse_diagonal, level.x.data(), level.d.data(),
                                          level.Ad.data(), workspace_);
  }
  coarsest_.compute(Eigen::MatrixXd(assemble(levels_.back().op)));
  if (coarsest_.info() != Eigen::Success) {
    throw SolveError(formatted("the coarsest lattice (%zu nodes) gives a matrix that is not positive definite",
                               levels_.back().op.size()));
  }
}

// Chebyshev iteration for A x = r on D^-1 A.
// @param before  the coarse correction: from x = 0, and the residual is left in level.r. Else from level.x, and level.r
// is not needed afterwards.
void Multigrid::smooth(Level& level, bool before) {
  const std::ptrdiff_t n = level.op.size();
  const double high = level.lambda_max, low = high / kSmoothingRange;
  const double theta = (high + low) / 2, delta = (high - low) / 2, sigma = theta / delta;
  double rho = 1 / sigma;
  const float* D = level.inverse_diagonal.data();
  float *x = level.x.data(), *r = level.r.data(), *d = level.d.data(), *Ad = level.Ad.data();
  const auto first = static_cast<float>(1 / theta);
  for_chunks(n, [&](std::ptrdiff_t b, std::ptrdiff_t e) {
    for (std::ptrdiff_t i = b; i < e; ++i) {
      d[i] = D[i] * r[i] * first;
      x[i] = before ? d[i] : x[i] + d[i];
    }
  });
  for (int step = 1;; ++step) {
    const double next = 1 / (2 * sigma - rho);
    const bool last = step == kSmoothingDegree;
    if (last && !before) return;
    level.op.apply(d, Ad, workspace_);
    const auto on = static_cast<float>(next * rho), by = static_cast<float>(2 * next / delta);
    for_chunks(n, [&](std::ptrdiff_t b, std::ptrdiff_t e) {
      for (std::ptrdiff_t i = b; i < e; ++i) {
        r[i] -= Ad[i];
        if (last) continue;
        d[i] = on * d[i] + by * D[i] * r[i];
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
    const Eigen::Map<const Eigen::VectorXf> r(level.r.data(), level.op.size());
    Eigen::Map<Eigen::VectorXf>(level.x.data(), level.op.size()) = coarsest_.solve(r.cast<double>()).cast<float>();
    return;
  }
  smooth(level, true);
  Level& coarse = levels_[l + 1];
  const std::ptrdiff_t fx = level.op.n()[0], fy = level.op.n()[1], fz = level.op.n()[2];
  const std::ptrdiff_t cy = coarse.op.n()[1], cz = coarse.op.n()[2];
  transfer_.resize(std::max<std::size_t>(transfer_.size(), fx * fy * cz + fx * cy * cz));
  float *half = transfer_.data(), *quarter = half + fx * fy * cz;
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
  const std::ptrdiff_t n = level.op.size();
  const double norm = std::sqrt(dot(n, r, r));  // which keeps single precision far from its ends
  if (!(norm > 0)) {
    std::fill(z, z + n, 0.0);
    return;
  }
  for_chunks(n, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t i = begin; i < end; ++i) level.r[i] = static_cast<float>(r[i] / norm);
  });
  cycle(0);
  for_chunks(n, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t i = begin; i < end; ++i) z[i] = norm * level.x[i];
  });
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
