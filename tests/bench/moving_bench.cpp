// A domain that moves in one background: what an update costs beside a mesh that is made anew.
// ./build/release/tests/bench/moving_bench

#include <benchmark/benchmark.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numbers>
#include <optional>

#include "mesh/certify/certificate.h"
#include "mesh/moving_mesh.h"
#include "mesh/universal_mesh.h"
#include "reconstruct/solve/fit_ssd.h"
#include "tests/support/certified.h"
#include "tests/support/domains.h"

using namespace umtet;

namespace {

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// A ball at the origin, as a level set of 50,000 points on its surface.
LevelSet ball_of_points(double radius) {
  constexpr int kPoints = 50000;
  const double turn = std::numbers::pi * (3 - std::sqrt(5.));  // a spiral that covers the sphere evenly
  OrientedPointCloud cloud;
  for (int k = 0; k < kPoints; ++k) {
    const double z = 1 - (2 * k + 1.) / kPoints, r = std::sqrt(1 - z * z);
    cloud.normals.emplace_back(r * std::cos(turn * k), r * std::sin(turn * k), z);
    cloud.points.push_back(radius * cloud.normals.back());
  }
  return fit_ssd(cloud, {}).psi;
}

/// A ball drifting so many thousandths of a cell a step, to and fro where the background is short: CPU time of 100
/// updates, and of meshing anew at every tenth of them. Either holds the mesh in memory with its ids, and its
/// certificate; anew asks psi at every vertex of the background. psi is a sum of squares, or the level set of a cloud.
void drifting_ball(benchmark::State& state) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const double n_tets = 1e3 * static_cast<double>(state.range(0));
  // Cells of edge 1 and a ball of radius 5.5: 32k tets. 100 steps cross 25 cells.
  constexpr double kRadius = 5.5, kLength = 40, kMargin = .6;
  const double width = std::max(std::sqrt(n_tets / 46 / kLength), 2 * (kRadius + kMargin));
  const Vec3 half(.5 * n_tets / 46 / (width * width), .5 * width, .5 * width);
  const double reach = std::min(12.5, half.x() - kRadius - kMargin), step = 1e-3 * static_cast<double>(state.range(1));
  std::optional<LevelSet> level_set;
  if (state.range(2) != 0) level_set = ball_of_points(kRadius);
  const BackgroundMesh background(a15(), Box(-half, half), a15().mean_edge / a15().period[0]);
  const auto at = [&](int k) {
    const double way = std::fmod(step * k, 4 * reach);
    testing::AnalyticDomain ball;
    if (level_set) {
      ball.psi = [&psi = *level_set, x = std::abs(way - 2 * reach) - reach](const Vec3& p, Vec3* g, Mat3* H) {
        return psi.evaluate(p - Vec3(x, 0, 0), g, H);
      };
      return ball;
    }
    ball.psi = [x = std::abs(way - 2 * reach) - reach](const Vec3& p, Vec3* g, Mat3* H) {
      const Vec3 d(p.x() - x, p.y(), p.z());
      if (g) *g = 2 * d;
      if (H) *H = 2 * Mat3::Identity();
      return d.squaredNorm() - kRadius * kRadius;
    };
    return ball;
  };
  double updates = 0, certificates = 0, anew = 0, n_faces = 0, n_recalled = 0, n_values = 0, worst = 1, worst_anew = 1;
  double lack01 = -1, lack_mean = -1;
  for (auto _ : state) {
    UniversalMesh moving(background);
    moving.update(at(0));
    for (int k = 1; k <= 100; ++k) {
      const auto psi = at(k);
      double cpu = cpu_seconds();
      const UmUpdate& update = moving.update(psi);
      updates += cpu_seconds() - cpu;
      cpu = cpu_seconds();
      const MeshCertificate certificate = moving.certify(update.mesh, psi);
      certificates += cpu_seconds() - cpu;
      if (!failures(certificate).empty()) return state.SkipWithError(failures(certificate).front().c_str());
      worst = std::min(worst, certificate.quality.min);
      n_values += static_cast<double>(update.mesh.n_psi_evaluations);
      if (update.mesh.status != UmStatus::Success) return state.SkipWithError(update.mesh.evidence.what.c_str());
      n_faces += static_cast<double>(update.mesh.submesh.positive_faces.size());
      n_recalled += static_cast<double>(update.n_recalled);
      if (k % 10 != 0) continue;
      cpu = cpu_seconds();
      const UmResult fresh = universal_mesh(background, psi);
      const MeshCertificate c = testing::certificate_of(fresh, psi, background.h());
      if (!failures(c).empty()) return state.SkipWithError(failures(c).front().c_str());
      worst_anew = std::min(worst_anew, c.quality.min);
      anew += 10 * (cpu_seconds() - cpu);
      lack01 = std::max(lack01, c.quality.p01 - certificate.quality.p01);
      lack_mean = std::max(lack_mean, c.quality.mean - certificate.quality.mean);
    }
  }
  state.counters["tets"] = static_cast<double>(background.n_tets());
  state.counters["us_per_face"] = 1e6 * (updates + certificates) / n_faces;
  state.counters["of_that_certificate"] = 1e6 * certificates / n_faces;
  state.counters["anew_over_update"] = anew / (updates + certificates);
  state.counters["psi_per_face"] = n_values / n_faces;
  state.counters["least_Q_anew"] = worst_anew;
  state.counters["recalled_per_face"] = n_recalled / n_faces;
  state.counters["least_Q"] = worst;
  state.counters["p01_less_than_anew"] = lack01;
  state.counters["mean_less_than_anew"] = lack_mean;
}
BENCHMARK(drifting_ball)
    ->ArgNames({"thousand_tets", "thousandths_of_a_cell", "cloud"})
    ->ArgsProduct({{100, 1000, 8000}, {250}, {0, 1}})
    ->ArgsProduct({{1000}, {20, 0}, {0, 1}})
    ->Unit(benchmark::kSecond)
    ->Iterations(1);

}  // namespace

BENCHMARK_MAIN();
