#include "reconstruct/solve/multilevel_fit.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bitset>
#include <cmath>
#include <numeric>

#include "common/first_touch.h"
#include "reconstruct/solve/ssd_band.h"

namespace umtet {

namespace {

constexpr int kEdge = LatticeBlocks::kEdge, kNodes = LatticeBlocks::kNodes;
using Block = Eigen::Array<float, kNodes, 1>;

Eigen::Map<Block> block(std::vector<float>& v, int b) {
  return Eigen::Map<Block>(v.data() + static_cast<std::size_t>(b) * kNodes);
}
Eigen::Map<const Block> block(const std::vector<float>& v, int b) {
  return Eigen::Map<const Block>(v.data() + static_cast<std::size_t>(b) * kNodes);
}

// Sum over blocks in their order of what f returns for each: the same bits for any number of threads.
template <class F>
double sum_over_blocks(int n, std::vector<double>& partial, F&& f) {
  partial.resize(n);
  tbb::parallel_for(0, n, [&](int b) { partial[b] = f(b); });
  double sum = 0;
  for (const double p : partial) sum += p;
  return sum;
}

// Jacobi-PCG from zero; returns the solution.
std::vector<float> solve(const SsdBand& band, std::vector<float> r, double tolerance, int max_iterations,
                         const std::function<void(double)>& go_on, BandReport& report) {
  const int n = band.blocks().size();
  const std::vector<float>& D = band.inverse_diagonal();
  std::vector<float> x = touched<float>(r.size()), p = touched<float>(r.size()), Ap = touched<float>(r.size());
  std::vector<double> partial;
  double rz = sum_over_blocks(n, partial, [&](int b) {
    block(p, b) = block(D, b) * block(r, b);
    return static_cast<double>((block(p, b) * block(r, b)).sum());
  });
  const double rz0 = rz;
  report.residual = rz0 > 0 ? 1 : 0;
  while (report.residual > tolerance && report.iterations < max_iterations) {
    go_on(report.residual);
    band.apply(p.data(), Ap.data());
    const double pAp =
        sum_over_blocks(n, partial, [&](int b) { return static_cast<double>((block(p, b) * block(Ap, b)).sum()); });
    const auto alpha = static_cast<float>(rz / pAp);
    const double next = sum_over_blocks(n, partial, [&](int b) {
      block(x, b) += alpha * block(p, b);
      block(r, b) -= alpha * block(Ap, b);
      return static_cast<double>((block(D, b) * block(r, b).square()).sum());
    });
    const auto beta = static_cast<float>(next / rz);
    tbb::parallel_for(0, n, [&](int b) { block(p, b) = block(D, b) * block(r, b) + beta * block(p, b); });
    rz = next;
    report.residual = std::sqrt(rz / rz0);
    ++report.iterations;
  }
  report.converged = report.residual <= tolerance;
  return x;
}

}  // namespace

std::vector<SsdSample> resolved_samples(const std::vector<SsdSample>& samples, double most_area) {
  const auto in_block = [](const Eigen::Vector3i& c) { return c[0] % 8 + 8 * (c[1] % 8) + 64 * (c[2] % 8); };
  const std::vector<std::size_t> runs = block_runs(samples);
  const std::size_t n_runs = runs.size() - 1;
  std::vector<std::bitset<kNodes>> resolved(n_runs);
  std::vector<std::size_t> first(n_runs + 1, 0);  // of those that are kept
  tbb::parallel_for(std::size_t{0}, n_runs, [&](std::size_t run) {
    for (std::size_t i = runs[run]; i < runs[run + 1]; ++i) {
      const SsdSample& s = samples[i];
      if (std::max(s.w_gradient, s.gap2) <= most_area) resolved[run].set(in_block(cell_of(s)));
    }
    for (std::size_t i = runs[run]; i < runs[run + 1]; ++i)
      first[run + 1] += resolved[run][in_block(cell_of(samples[i]))] ? 1 : 0;
  });
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<SsdSample> kept = touched<SsdSample>(first.back());
  tbb::parallel_for(std::size_t{0}, n_runs, [&](std::size_t run) {
    std::size_t at = first[run];
    for (std::size_t i = runs[run]; i < runs[run + 1]; ++i)
      if (resolved[run][in_block(cell_of(samples[i]))]) kept[at++] = samples[i];
  });
  return kept;
}

LevelSet refine(const LevelSet& psi, const std::vector<SsdSample>& samples, double kappa, double tolerance,
                int max_iterations, const std::function<void(double)>& go_on, BandReport& report) {
  const Lattice& coarse = psi.lattice(psi.n_levels() - 1);
  const Lattice fine{coarse.origin, coarse.h / 2, (2 * (coarse.n.array() - 1) + 1).matrix()};
  const SsdBand band(psi.tables(), fine, kappa, samples);
  report = {fine.h, kappa, samples.size(), band.n_active()};
  std::vector<float> r;
  band.residual(psi, r);
  LevelSetBand result{band.blocks(), solve(band, std::move(r), tolerance, max_iterations, go_on, report)};
  tbb::parallel_for(0, result.blocks.size(), [&](int b) {
    for (float& c : block(result.coefficients, b)) c = static_cast<float>(fine.h * c);
  });
  return psi.with_band(std::move(result));
}

}  // namespace umtet
