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

// Nodes of a block are the lanes of one array.
constexpr int kBlockNodes = LatticeBlocks::kNodes;
using Block = Eigen::Array<float, kBlockNodes, 1>;

Eigen::Map<Block> block(std::vector<float>& v, int b) {
  return Eigen::Map<Block>(v.data() + static_cast<std::size_t>(b) * kBlockNodes);
}
Eigen::Map<const Block> block(const std::vector<float>& v, int b) {
  return Eigen::Map<const Block>(v.data() + static_cast<std::size_t>(b) * kBlockNodes);
}

// Jacobi-PCG from zero; returns the solution.
std::vector<float> solve(const SsdBand& band, std::vector<float> r, double tolerance, int max_iterations,
                         const std::function<void(double)>& go_on, BandReport& report, OtherParts* others) {
  const int first = band.first_own(), end = band.end_own();
  std::vector<double> partial(end - first);
  // Sum over blocks in their order of what f returns for each: the same bits for any number of threads and of parts.
  const auto sum_over_blocks = [&](const auto& f) {
    tbb::parallel_for(first, end, [&](int b) { partial[b - first] = f(b); });
    return others ? others->sum(partial) : std::accumulate(partial.begin(), partial.end(), 0.);
  };
  const std::vector<float>& D = band.inverse_diagonal();
  std::vector<float> x = touched<float>(r.size()), p = touched<float>(r.size()), Ap = touched<float>(r.size());
  double rz = sum_over_blocks([&](int b) {
    block(p, b) = block(D, b) * block(r, b);
    return static_cast<double>((block(p, b) * block(r, b)).sum());
  });
  const double rz0 = rz;
  report.residual = rz0 > 0 ? 1 : 0;
  while (report.residual > tolerance && report.iterations < max_iterations) {
    go_on(report.residual);
    if (others) others->fill(p.data());
    band.apply(p.data(), Ap.data());
    const double pAp = sum_over_blocks([&](int b) { return static_cast<double>((block(p, b) * block(Ap, b)).sum()); });
    const auto alpha = static_cast<float>(rz / pAp);
    const double next = sum_over_blocks([&](int b) {
      block(x, b) += alpha * block(p, b);
      block(r, b) -= alpha * block(Ap, b);
      return static_cast<double>((block(D, b) * block(r, b).square()).sum());
    });
    const auto beta = static_cast<float>(next / rz);
    tbb::parallel_for(first, end, [&](int b) { block(p, b) = block(D, b) * block(r, b) + beta * block(p, b); });
    rz = next;
    report.residual = std::sqrt(rz / rz0);
    ++report.iterations;
  }
  report.converged = report.residual <= tolerance;
  return x;
}

}  // namespace

std::vector<SsdSample> resolved_samples(std::vector<SsdSample> samples, double most_area) {
  const auto in_block = [](const Eigen::Vector3i& c) { return c[0] % 8 + 8 * (c[1] % 8) + 64 * (c[2] % 8); };
  const std::vector<std::size_t> runs = block_runs(samples);
  const std::size_t n_runs = runs.size() - 1;
  std::vector<std::bitset<kBlockNodes>> resolved(n_runs);
  tbb::parallel_for(std::size_t{0}, n_runs, [&](std::size_t run) {
    for (std::size_t i = runs[run]; i < runs[run + 1]; ++i) {
      const SsdSample& s = samples[i];
      if (std::max(s.w_gradient, s.gap2) <= most_area) resolved[run].set(in_block(cell_of(s)));
    }
  });
  std::size_t n = 0;
  for (std::size_t run = 0; run < n_runs; ++run) {
    for (std::size_t i = runs[run]; i < runs[run + 1]; ++i)
      if (resolved[run][in_block(cell_of(samples[i]))]) samples[n++] = samples[i];
  }
  samples.resize(n);
  if (2 * n < samples.capacity()) samples.shrink_to_fit();
  return samples;
}

std::vector<float> band_correction(const SsdBand& band, const LevelSet& psi, double tolerance, int max_iterations,
                                   const std::function<void(double)>& go_on, BandReport& report, OtherParts* others) {
  std::vector<float> r;
  band.residual(psi, r);
  std::vector<float> x = solve(band, std::move(r), tolerance, max_iterations, go_on, report, others);
  const double h = band.blocks().lattice().h;
  tbb::parallel_for(band.first_own(), band.end_own(), [&](int b) {
    for (float& c : block(x, b)) c = static_cast<float>(h * c);
  });
  return x;
}

LevelSet refine(const LevelSet& psi, const std::vector<SsdSample>& samples, double kappa, double tolerance,
                int max_iterations, const std::function<void(double)>& go_on, BandReport& report) {
  const Lattice& coarse = psi.lattice(psi.n_levels() - 1);
  const Lattice fine{coarse.origin, coarse.h / 2, (2 * (coarse.n.array() - 1) + 1).matrix()};
  const SsdBand band(psi.tables(), fine, kappa, samples);
  report = {fine.h, kappa, samples.size(), band.n_active()};
  return psi.with_band({band.blocks(), band_correction(band, psi, tolerance, max_iterations, go_on, report)});
}

}  // namespace umtet
