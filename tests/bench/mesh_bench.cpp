// Stage two: what a projection, a relaxation, a sweep, the search for omega_h and a whole mesh cost on one core,
// and what the least quality depends on.
// ./build/release/tests/bench/mesh_bench

#include <benchmark/benchmark.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <ctime>
#include <iterator>
#include <numeric>
#include <random>
#include <utility>

#include "mesh/certify/boundary_surface.h"
#include "mesh/certify/certificate.h"
#include "mesh/core/tet_quality.h"
#include "mesh/fast/projection/backtracking_projection.h"
#include "mesh/fast/smoothing/all_vertex_smoothing.h"
#include "mesh/fast/smoothing/p_norm_smoothing.h"
#include "mesh/moving_mesh.h"
#include "mesh/paper/dvr.h"
#include "mesh/sizes/body_size.h"
#include "mesh/submesh/crawl.h"
#include "mesh/universal_mesh.h"
#include "tests/support/bench_domains.h"
#include "tests/support/certified.h"
#include "tests/support/omega_h_shell.h"

using namespace umtet;

namespace {

/// omega_h of the torus, its positive vertices two fifths of the way to the boundary.
struct Half {
  testing::AnalyticDomain domain = testing::torus();
  double h;
  BackgroundMesh background;
  Submesh submesh;
  MovingMesh mesh;
  std::vector<int> interior;

  explicit Half(double n_tets)
      : h(h_for_tets(domain, domain.box, n_tets)),
        background(a15(), domain.box, h),
        submesh(find_submesh(background, domain)),
        mesh(submesh.mesh, true) {
    std::vector<int> all(submesh.mesh.V.size());
    std::iota(all.begin(), all.end(), 0);
    std::set_difference(all.begin(), all.end(), submesh.positive_vertices.begin(), submesh.positive_vertices.end(),
                        std::back_inserter(interior));
    for (const int i : submesh.positive_vertices) {
      mesh.move(i, mesh.V[i] + .4 * (closest_point(domain, mesh.V[i], h, {}).point - mesh.V[i]));
    }
  }
};

const Half& half() {
  static const Half data(100000);
  return data;
}

void closest_points(benchmark::State& state) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Half& data = half();
  ClosestPointParams params;
  params.method = static_cast<ClosestPointMethod>(state.range(0));
  std::int64_t n = 0;
  for (auto _ : state) {
    for (const int i : data.submesh.positive_vertices) {
      benchmark::DoNotOptimize(closest_point(data.domain, data.submesh.mesh.V[i], data.h, params));
    }
    n += static_cast<std::int64_t>(data.submesh.positive_vertices.size());
  }
  state.SetItemsProcessed(n);
}
BENCHMARK(closest_points)->ArgName("method")->Arg(0)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond);

void relaxations(benchmark::State& state) {
  const Half& data = half();
  std::int64_t n = 0;
  for (auto _ : state) {
    for (const int i : data.interior) {
      const RingOnLine line(data.mesh.ring(i), random_unit_vector(0, 0, i));
      benchmark::DoNotOptimize(max_min(line, static_cast<MaxMin>(state.range(0))));
    }
    n += static_cast<std::int64_t>(data.interior.size());
  }
  state.SetItemsProcessed(n);
}
#ifdef UMTET_WITH_GSL
BENCHMARK(relaxations)->ArgName("exact0_golden1")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
#else
BENCHMARK(relaxations)->ArgName("exact0_golden1")->Arg(1)->Unit(benchmark::kMillisecond);
#endif

void dvr_sweeps(benchmark::State& state) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(state.range(0)));
  const Half& data = half();
  MovingMesh mesh = data.mesh;
  const RelaxationOrder order(mesh, data.interior);
  int r = 0;
  for (auto _ : state) dvr(mesh, order, data.submesh.background_vertex, {}, r++, 1);
  state.SetItemsProcessed(r * static_cast<std::int64_t>(data.interior.size()));
}
BENCHMARK(dvr_sweeps)->ArgName("threads")->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

/// All vertices at once, from where one at a time has ended, as in a patch of repair. `s_per_tet` is of one evaluation
/// of the norm.
void all_vertices(benchmark::State& state) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const testing::AnalyticDomain domain = testing::torus();
  ActiveLayer settled = testing::omega_h_shell(domain, 2000);
  project(settled, domain);
  smooth(settled, domain, {});
  AllVertexReport report;
  for (auto _ : state) {
    ActiveLayer layer = settled;
    report = smooth_all_vertices(layer, domain, 1);
  }
  state.counters["evaluations"] = report.evaluations;
  state.counters["tets"] = static_cast<double>(settled.C.size());
  state.counters["s_per_tet"] =
      benchmark::Counter(static_cast<double>(settled.C.size()) * report.evaluations,
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(all_vertices)->Unit(benchmark::kMillisecond);

void search_full_loop(benchmark::State& state) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Half& data = half();
  for (auto _ : state) benchmark::DoNotOptimize(find_submesh(data.background, data.domain));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(data.submesh.mesh.C.size()));
}
BENCHMARK(search_full_loop)->Unit(benchmark::kMillisecond);

void search_crawl(benchmark::State& state) {
  const Half& data = half();
  for (auto _ : state) benchmark::DoNotOptimize(crawl(data.background, data.domain, data.domain.boundary_seeds));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(data.submesh.mesh.C.size()));
}
BENCHMARK(search_crawl)->Unit(benchmark::kMillisecond);

/// Items are tets of the result.
void whole_mesh(benchmark::State& state) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(state.range(1)));
  const Half& data = half();
  UmParams params;
  params.mode = UmMode::Paper;
  params.paper.max_min = static_cast<MaxMin>(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(universal_mesh(data.background, data.domain, params));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(data.submesh.mesh.C.size()));
}
BENCHMARK(whole_mesh)
    ->ArgNames({"exact0_golden1", "threads"})
#ifdef UMTET_WITH_GSL
    ->Args({0, 1})
    ->Args({0, 2})
#endif
    ->Args({1, 1})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1);

/// The least Q over seeds of the random directions and tangents: counters least_Q_min and least_Q_max.
void least_quality(benchmark::State& state) {
  const Half& data = half();
  UmParams params;
  params.mode = UmMode::Paper;
  params.paper.directions = static_cast<DirectionRule>(state.range(0));
  double worst = 1, best = 0;
  for (auto _ : state) {
    for (params.paper.seed = 0; params.paper.seed < 6; ++params.paper.seed) {
      const UmResult result = universal_mesh(data.background, data.domain, params);
      if (result.status != UmStatus::Success) {
        state.SkipWithError(result.evidence.what.c_str());
        return;
      }
      const TetMesh mesh{result.final, result.submesh.mesh.C};
      double least = 1;
      for (const Tet& t : mesh.C) least = std::min(least, mean_ratio(mesh, t));
      worst = std::min(worst, least);
      best = std::max(best, least);
    }
  }
  state.counters["least_Q_min"] = worst;
  state.counters["least_Q_max"] = best;
}
static_assert(static_cast<int>(DirectionRule::AxesInTurn) == 0 && static_cast<int>(DirectionRule::Random) == 1);
BENCHMARK(least_quality)
    ->ArgName("axes0_random1")
    ->Arg(0)
    ->Arg(1)
    ->Unit(benchmark::kSecond)
    ->UseRealTime()
    ->Iterations(1);

/// The mesher beyond the paper, all in. CPU time; counters: least Q, 1 % quantile, microseconds per tet.
void fast_mesh(benchmark::State& state) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(state.range(2)));
  const std::array<testing::AnalyticDomain, 7> domains = {testing::sphere(),
                                                          testing::torus(),
                                                          testing::equation_9(),
                                                          testing::banchoff_chmutov_4(),
                                                          testing::banchoff_chmutov_6(),
                                                          testing::banchoff_chmutov_8(),
                                                          testing::ellipsoid({1, 1, .1})};
  const testing::AnalyticDomain& domain = domains[static_cast<std::size_t>(state.range(0))];
  const double n_tets = 1e3 * static_cast<double>(state.range(1));
  const BackgroundMesh background(a15(), domain.box,
                                  h_for_tets(domain, domain.box, n_tets, ClassificationSource::Chosen));
  UmResult result;
  for (auto _ : state) result = universal_mesh(background, domain);
  const TetMesh mesh{result.final, result.submesh.mesh.C};
  std::vector<double> quality;
  for (const Tet& t : mesh.C) quality.push_back(mean_ratio(mesh, t));
  std::sort(quality.begin(), quality.end());
  state.SetLabel(domain.name + ": " + to_string(result.status));
  state.counters["tets"] = static_cast<double>(quality.size());
  state.counters["least_Q"] = quality.front();
  state.counters["Q_1_percent"] = quality[quality.size() / 100];
  state.counters["s_per_tet"] = benchmark::Counter(
      static_cast<double>(quality.size()), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(fast_mesh)
    ->ArgNames({"shape", "thousand_tets", "threads"})
    ->ArgsProduct({{0, 1, 2, 3, 4, 5, 6}, {100, 500}, {1}})
    ->Args({3, 500, 2})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

struct AllIn {
  double cpu, wall;  ///< s
  double n_tets, n_faces;
};

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Classification, layer, repair and certificate of {psi < 0}, psi a compiled function.
AllIn mesh_and_certify(const testing::AnalyticDomain& domain, double n_tets, int threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  const double cpu = cpu_seconds();
  const auto wall = std::chrono::steady_clock::now();
  const BackgroundMesh background(a15(), domain.box,
                                  h_for_tets(domain, domain.box, n_tets, ClassificationSource::Chosen));
  UmResult result = universal_mesh(background, domain);
  const TetMesh mesh{std::move(result.final), std::move(result.submesh.mesh.C)};
  CertificateInput input;
  input.mesh = &mesh;
  input.h = background.h();
  input.positive_faces = &result.submesh.positive_faces;
  input.psi = ImplicitFunctionRef(domain);
  const MeshCertificate certificate = certify(input);
  return {cpu_seconds() - cpu, std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count(),
          static_cast<double>(certificate.n_tets), static_cast<double>(certificate.n_positive_faces)};
}

/// Tets a second on one core, all in; microseconds of CPU per positive face.
void all_in(benchmark::State& state) {
  const std::array<testing::AnalyticDomain, 5> domains = {testing::sphere(), testing::torus(),
                                                          testing::banchoff_chmutov_4(), testing::banchoff_chmutov_6(),
                                                          testing::banchoff_chmutov_8()};
  const testing::AnalyticDomain& domain = domains[static_cast<std::size_t>(state.range(0))];
  AllIn run{};
  for (auto _ : state) run = mesh_and_certify(domain, 1e3 * static_cast<double>(state.range(1)), 1);
  state.SetLabel(domain.name);
  state.counters["tets"] = run.n_tets;
  state.counters["tets_per_s"] = run.n_tets / run.cpu;
  state.counters["us_per_face"] = 1e6 * run.cpu / run.n_faces;
}
BENCHMARK(all_in)
    ->ArgNames({"shape", "thousand_tets"})
    ->ArgsProduct({{0, 1, 2}, {500, 4000, 8000}})
    ->ArgsProduct({{3, 4}, {500}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

/// Nanoseconds a tet of the parts of a certificate that look at all tets: their faces, and all but psi.
void certificates(benchmark::State& state) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const testing::AnalyticDomain domain = testing::torus();
  const BackgroundMesh background(a15(), domain.box, h_for_tets(domain, domain.box, 500000));
  const Submesh submesh = find_submesh(background, domain);
  const std::vector<Tet>& C = submesh.mesh.C;
  for (auto _ : state) {
    if (state.range(0) != 0) {
      CertificateInput input;
      input.mesh = &submesh.mesh;
      input.h = background.h();
      benchmark::DoNotOptimize(certify(input));
    } else {
      benchmark::DoNotOptimize(boundary_faces(C, submesh.mesh.V.size()));
    }
  }
  state.counters["per_tet"] = benchmark::Counter(
      static_cast<double>(C.size()), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(certificates)->ArgName("faces0_all1")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

/// Ratios in one run: the exponent of CPU time over tets from 500k to 4M, and how much faster two threads are.
void all_in_ratios(benchmark::State& state) {
  const testing::AnalyticDomain domain = testing::banchoff_chmutov_4();
  AllIn small{}, large{}, two{};
  for (auto _ : state) {
    mesh_and_certify(domain, 500000, 1);  // the tables of the tiling are made once
    small = mesh_and_certify(domain, 500000, 1);
    large = mesh_and_certify(domain, 4000000, 1);
    two = mesh_and_certify(domain, 4000000, 2);
  }
  state.counters["exponent"] = std::log(large.cpu / small.cpu) / std::log(large.n_tets / small.n_tets);
  state.counters["two_threads"] = large.wall / two.wall;
}
BENCHMARK(all_in_ratios)->Unit(benchmark::kSecond)->Iterations(1)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
