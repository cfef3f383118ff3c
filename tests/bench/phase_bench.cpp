// Each phase of a mesh once more, for callgrind, which counts its instructions and misses of caches:
// tests/bench/gate.py. UMTET_SLOWER=.15 projects so much of the vertices twice: a phase that is 15 % slower, for the
// test of the gate.

#include <benchmark/benchmark.h>
#include <oneapi/tbb/global_control.h>
#include <unistd.h>
#include <valgrind/callgrind.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "mesh/certify/certificate.h"
#include "mesh/embedding/self_intersections.h"
#include "mesh/implicit/closest_point.h"
#include "mesh/implicit/surface_distance.h"
#include "mesh/io/tet_mesh_io.h"
#include "mesh/sizes/body_size.h"
#include "mesh/universal_mesh.h"
#include "reconstruct/cloud/neighbours/neighbourhoods.h"
#include "reconstruct/cloud/normals/normal_estimation.h"
#include "reconstruct/solve/fit_ssd.h"
#include "tests/reconstruct/triangles/solids.h"
#include "tests/support/bench_domains.h"
#include "tests/support/clouds.h"
#include "tests/support/gradings.h"
#include "umtet/umtet.h"

using namespace umtet;

namespace {

constexpr int kPoints = 5000;
constexpr double kTets = 20000;
constexpr int kThinPoints = 1500;

struct Phase {
  std::string name;
  std::function<void()> work;
};

/// A flat ellipsoid, two spirals of samples: one on each side.
FittedBody thin_scan() {
  OrientedPointCloud cloud;
  const testing::AnalyticDomain lens = testing::ellipsoid({1, 1, .1});
  for (int i = 0; i < kThinPoints; ++i) {
    const double r = std::sqrt((i / 2 + .5) / (kThinPoints / 2)), turn = 2.399963229728653 * (i / 2);  // golden angle
    const Vec3 x(r * std::cos(turn), r * std::sin(turn), (i % 2 ? -.1 : .1) * std::sqrt(1 - r * r));
    cloud.points.push_back(x);
    cloud.normals.push_back(lens.gradient(x).normalized());
  }
  return fit_body(std::move(cloud));
}

struct Meshed {
  testing::AnalyticDomain domain = testing::banchoff_chmutov_4();
  BackgroundMesh background{a15(), domain.box, h_for_tets(domain, domain.box, kTets, ClassificationSource::Chosen)};
  UmParams params;
  ChosenSubmesh chosen = choose_submesh(background, domain, params);
  UmResult result = fit_submesh(background, domain, params, chosen);
  TetMesh mesh{result.final, result.submesh.mesh.C};
  OrientedPointCloud cloud = test::torus_cloud(kPoints);
  LevelSet psi = fit_ssd(cloud, {}).psi;
  FittedBody thin = thin_scan();
};

std::vector<Phase> phases(const Meshed& m, const std::filesystem::path& file) {
  std::vector<Phase> all;
  const auto phase = [&](const char* name, std::function<void()> work) { all.push_back({name, std::move(work)}); };
  phase("neighbours", [&] { benchmark::DoNotOptimize(Neighbourhoods(m.cloud.points)); });
  phase("normals", [&] { benchmark::DoNotOptimize(estimate_normals(m.cloud.points)); });
  phase("fit", [&] { benchmark::DoNotOptimize(fit_ssd(m.cloud, {})); });
  phase("psi", [&] {
    Vec3 gradient;
    double sum = 0;
    for (const Vec3& x : m.cloud.points) sum += m.psi.evaluate(x, &gradient, nullptr);
    benchmark::DoNotOptimize(sum);
  });
  phase("graded background", [] { benchmark::DoNotOptimize(GradedMesh(testing::spots(0, .02, .4))); });
  phase("classification", [&] { benchmark::DoNotOptimize(choose_submesh(m.background, m.domain, m.params)); });
  phase("projection", [&] {
    const std::vector<int>& V = m.result.submesh.positive_vertices;
    const char* slower = std::getenv("UMTET_SLOWER");
    const auto n_twice = static_cast<std::size_t>((slower ? std::atof(slower) : 0) * static_cast<double>(V.size()));
    for (std::size_t i = 0; i < V.size() + n_twice; ++i)
      benchmark::DoNotOptimize(closest_point(m.domain, m.result.submesh.mesh.V[V[i % V.size()]], m.background.h(), {}));
  });
  phase("smoothing and repair",
        [&] { benchmark::DoNotOptimize(fit_submesh(m.background, m.domain, m.params, m.chosen)); });
  phase("certificate", [&] {
    CertificateInput input;
    input.mesh = &m.mesh;
    input.h = m.background.h();
    input.positive_faces = &m.result.submesh.positive_faces;
    input.psi = ImplicitFunctionRef(m.domain);
    benchmark::DoNotOptimize(certify(input));
  });
  phase("embedding", [&] { benchmark::DoNotOptimize(self_intersections(m.mesh.V, m.result.submesh.positive_faces)); });
  phase("distances", [&] {
    const SurfaceDistance distance(m.mesh.V, m.result.submesh.positive_faces);
    benchmark::DoNotOptimize(distance.distances(m.cloud.points));
  });
  phase("graded body", [] {
    const testing::AnalyticDomain flat = testing::ellipsoid({1, .4, .1});
    Options options;
    options.box = flat.box;
    options.body.mesh.background = "graded";
    options.body.mesh.tets = 6000;
    benchmark::DoNotOptimize(mesh_body(flat, options));
  });
  phase("thin scan", [&] {
    Options options;
    options.body.mesh.background = "graded";
    options.body.mesh.h = .12;
    options.body.mesh.h_min = .06;
    benchmark::DoNotOptimize(mesh_body(m.thin, options));
  });
  phase("part with edges", [] {
    Options options;
    options.body.mesh.h = .1;
    benchmark::DoNotOptimize(mesh_body(test::cube(), options));
  });
  phase("writing", [&, file] { write_vtu(file, {.mesh = m.mesh, .point_data = {}, .cell_data = {}}); });
  return all;
}

}  // namespace

/// phase_bench [REGEX]: those whose names match.
int main(int argc, char** argv) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const std::regex wanted(argc > 1 ? argv[1] : ".*");
  const Meshed meshed;
  const auto file = std::filesystem::temp_directory_path() / ("phases_" + std::to_string(getpid()) + ".vtu");
  for (const Phase& phase : phases(meshed, file))
    if (std::regex_search(phase.name, wanted)) {
      phase.work();  // tables that are made once
      CALLGRIND_START_INSTRUMENTATION;
      CALLGRIND_ZERO_STATS;
      phase.work();
      CALLGRIND_DUMP_STATS_AT(phase.name.c_str());
      CALLGRIND_STOP_INSTRUMENTATION;
    }
  std::filesystem::remove(file);
  return 0;
}
