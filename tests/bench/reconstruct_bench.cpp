// Stage one: what a max-ent basis, an evaluation of psi, an application of the operator and a whole fit cost.
// ./build/release/tests/bench/reconstruct_bench

#include <benchmark/benchmark.h>
#include <sys/resource.h>
#include <tbb/global_control.h>

#include "reconstruct/basis/lme_lattice.h"
#include "tests/support/lme_scattered.h"
#include "reconstruct/cloud/neighbours/cloud_neighbours.h"
#include "reconstruct/cloud/neighbours/morton_order.h"
#include "reconstruct/cloud/survey/cloud_survey.h"
#include "reconstruct/solve/fit_ssd.h"
#include "reconstruct/solve/ssd_operator.h"
#include "tests/support/clouds.h"
#include "tests/support/sampled_domains.h"

using namespace umtet;

namespace {

// The torus on lattices from .24 down to .03: four levels.
const LevelSet& level_set() {
  static const LevelSet psi = [] {
    SsdParams p;
    p.spacing = 0.03;
    p.coarsest_nodes = 5000;
    return fit_ssd(test::torus_cloud(50000), p).psi;
  }();
  return psi;
}

// Positions near the surface; coherent: in the order in which a mesher visits them, neighbours in memory one after the
// other.
std::vector<Vec3> places(bool coherent) {
  std::vector<Vec3> x = test::torus_cloud(100000, 3).points;
  if (!coherent) return x;
  const auto key = [](const Vec3& p) {
    return std::make_tuple(std::floor(p[2] / 0.03), std::floor(p[1] / 0.03), p[0]);
  };
  std::sort(x.begin(), x.end(), [&](const Vec3& a, const Vec3& b) { return key(a) < key(b); });
  return x;
}

void Basis1dByNewton(benchmark::State& state) {
  double x = 10;
  for (auto _ : state) {
    benchmark::DoNotOptimize(evaluate_lme_1d(LmePrior{}, 30, x));
    x = x > 18 ? 10 : x + 0.0371;
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(Basis1dByNewton);

void Basis1dByTable(benchmark::State& state) {
  const LmeTables tables{LmePrior{}};
  LmeBasis1d B;
  double x = 10;
  for (auto _ : state) {
    tables.evaluate<true>(30, x, B);
    benchmark::DoNotOptimize(B);
    x = x > 18 ? 10 : x + 0.0371;
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(Basis1dByTable);

void ScatteredBasis(benchmark::State& state) {
  std::vector<Vec3> nodes;
  for (int a = 0; a < 1000; ++a) nodes.push_back(Vec3(a % 10, a / 10 % 10, a / 100));
  const LmeScattered basis(nodes, LmePrior{}, 1.0);
  for (auto _ : state) benchmark::DoNotOptimize(basis.evaluate(Vec3(4.3, 5.1, 4.8)));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(ScatteredBasis);

// range(0): 0 value, 1 with gradient, 2 with gradient and Hessian; range(1) levels; range(2): 0 random order, 1
// coherent
void EvaluatePsi(benchmark::State& state) {
  const std::vector<Vec3> x = places(state.range(2) == 1);
  Vec3 g;
  Mat3 H;
  const LevelSet psi = level_set().band_limited(level_set().lattice(static_cast<int>(state.range(1)) - 1).h);
  for (auto _ : state) {
    double sum = 0;
    for (const Vec3& p : x)
      sum += psi.evaluate(p, state.range(0) > 0 ? &g : nullptr, state.range(0) > 1 ? &H : nullptr);
    benchmark::DoNotOptimize(sum);
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(x.size()));
  state.counters["levels"] = psi.n_levels();
}
BENCHMARK(EvaluatePsi)
    ->ArgNames({"derivatives", "levels", "coherent"})
    ->ArgsProduct({{0, 1, 2}, {1, 2, 3, 4}, {0, 1}})
    ->Unit(benchmark::kMillisecond);

// Items are nodes; range(0) samples on 121 x 121 x 61 nodes, one thread.
void ApplyOperator(benchmark::State& state) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const LmeTables tables{LmePrior{}};
  std::vector<SsdSample> samples;
  for (const Vec3& x : test::torus_cloud(static_cast<int>(state.range(0))).points) {
    samples.push_back({x / 0.0276 + Vec3(60, 60, 30), Vec3::UnitX(), 1, 1});
  }
  const SsdOperator op(tables, {121, 121, 61}, 0.01, samples);
  std::vector<double> c(op.size() + SsdOperator::kPad, 1.0), y(c), work;
  for (auto _ : state) op.apply(c.data(), y.data(), work);
  state.SetItemsProcessed(state.iterations() * op.size());
}
BENCHMARK(ApplyOperator)->Arg(0)->Arg(200000)->Unit(benchmark::kMillisecond);

void SampleAreas(benchmark::State& state) {
  const auto cloud = test::torus_cloud(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(sample_areas(cloud.points));
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(SampleAreas)->Arg(200000)->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);

// A full lattice of 0.9 M nodes with 200k points; CPU time of all threads.
void FitFullLattice(benchmark::State& state) {
  const auto cloud = test::torus_cloud(200000);
  SsdParams p;
  p.spacing = 0.0232;
  p.smoothing = 0.01;
  p.tolerance = 1e-5;
  p.solver = SsdSolver::Full;
  for (auto _ : state) {
    const SsdFit fit = fit_ssd(cloud, p);
    state.counters["nodes"] = static_cast<double>(fit.report.n_nodes);
    state.counters["iterations"] = fit.report.iterations;
  }
}
BENCHMARK(FitFullLattice)->MeasureProcessCPUTime()->Iterations(2)->Unit(benchmark::kSecond);

// The same samples with noise along each axis, in thousandths of the diagonal, and 6 degrees on the normals.
OrientedPointCloud noisy(OrientedPointCloud cloud, double per_mille) {
  if (per_mille == 0) return cloud;
  const double sigma = 1e-3 * per_mille * test::box_diagonal(cloud.points);
  return test::with_tilted_normals(test::with_noise(std::move(cloud), sigma), 6);
}

// range(0) points of eq. (9), range(1) noise in thousandths of the diagonal; spacing and smoothing from the cloud.
void FitEquation9(benchmark::State& state) {
  const auto clean = test::sampled(testing::equation_9(), static_cast<std::size_t>(state.range(0)), 5);
  const auto truth = test::sampled(testing::equation_9(), 20000, 99).points;
  const double diagonal = test::box_diagonal(clean.points);
  auto cloud = noisy(clean, static_cast<double>(state.range(1)));
  sort_in_space(cloud);  // as preparation does
  for (auto _ : state) {
    SsdParams p;
    p.noise = noise_along_normals(cloud.points);
    const SsdFit fit = fit_ssd(cloud, p);
    state.PauseTiming();
    const auto [mean, most] = test::mean_and_max_distance(fit.psi, truth);
    state.counters["mean_over_diagonal"] = mean / diagonal;
    state.counters["max_over_diagonal"] = most / diagonal;
    int iterations = fit.report.iterations;
    for (const BandReport& band : fit.report.bands) iterations = std::max(iterations, band.iterations);
    state.counters["iterations"] = iterations;
    state.ResumeTiming();
  }
}
BENCHMARK(FitEquation9)
    ->Args({50000, 0})
    ->Args({500000, 0})
    ->Args({50000, 5})
    ->MeasureProcessCPUTime()
    ->Iterations(1)
    ->Repetitions(3)
    ->ReportAggregatesOnly()
    ->Unit(benchmark::kSecond);

// range(0) points of a torus on a lattice of range(1) million nodes around it.
void FitLargeTorus(benchmark::State& state) {
  const auto cloud = test::torus_cloud(static_cast<int>(state.range(0)));
  SsdParams p;
  p.spacing = std::cbrt(2.8 * 2.8 * 0.8 / (1e6 * static_cast<double>(state.range(1))));
  for (auto _ : state) {
    const SsdFit fit = fit_ssd(cloud, p);
    int iterations = fit.report.iterations;
    for (const BandReport& band : fit.report.bands) iterations = std::max(iterations, band.iterations);
    state.counters["iterations"] = iterations;
    state.counters["nodes"] = static_cast<double>(fit.report.n_nodes);
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    state.counters["peak_MB"] = static_cast<double>(usage.ru_maxrss) / 1024;
  }
}
BENCHMARK(FitLargeTorus)
    ->Args({1000000, 8})
    ->Args({2000000, 28})
    ->MeasureProcessCPUTime()
    ->Iterations(1)
    ->Unit(benchmark::kSecond);

}  // namespace

BENCHMARK_MAIN();
