// Graded meshes: what a background of several sizes costs, what costs by angles do, and what a mesh costs as it grows.
// ./build/release/tests/bench/graded_bench

#include <benchmark/benchmark.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "mesh/background/vertex_links.h"
#include "mesh/classification/star_cost_table.h"
#include "mesh/core/tet_quality.h"
#include "mesh/fast/flips/flipped_submesh.h"
#include "mesh/octree/graded_mesh.h"
#include "mesh/universal_mesh.h"
#include "tests/support/domains.h"
#include "tests/support/gradings.h"

using namespace umtet;

namespace {

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// A background that is fine at eight points: what building it and asking it costs on one core, in microseconds of CPU,
/// how much memory it keeps, and the worst tet that has no corner at the background boundary.
void graded_background(benchmark::State& state) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  Grading grading = testing::spots(0, .004, 1e-2 * static_cast<double>(state.range(0)), 8);
  grading.transition_sweeps = static_cast<int>(state.range(1));
  double build = 0, stars = 0, links = 0;
  std::optional<GradedMesh> mesh;
  for (auto _ : state) {
    double cpu = cpu_seconds();
    mesh.emplace(grading);
    build = cpu_seconds() - cpu;
    std::vector<std::int64_t> list;
    cpu = cpu_seconds();
    for (std::int64_t v = 0; v < mesh->n_vertices(); ++v) list.clear(), mesh->star(v, list);
    stars = cpu_seconds() - cpu;
    cpu = cpu_seconds();
    for (std::int64_t v = 0; v < mesh->n_vertices(); ++v) list.clear(), mesh->link(v, list);
    links = cpu_seconds() - cpu;
  }
  const auto n_tets = static_cast<double>(mesh->n_tets()), n_vertices = static_cast<double>(mesh->n_vertices());
  double least_q = 1, n_transitions = 0;
  DihedralRange angles{180, 0};
  for (std::int64_t t = 0; t < mesh->n_tets(); ++t) {
    n_transitions += mesh->is_transition(t) ? 1 : 0;
    const auto v = mesh->tet(t);
    if (std::any_of(v.begin(), v.end(), [&](std::int64_t i) { return mesh->on_boundary(i); })) continue;
    const Vec3 a = mesh->position(v[0]), b = mesh->position(v[1]), c = mesh->position(v[2]), d = mesh->position(v[3]);
    const DihedralRange own = dihedral_range(a, b, c, d);
    least_q = std::min(least_q, mean_ratio(a, b, c, d));
    angles = {std::min(angles.min_deg, own.min_deg), std::max(angles.max_deg, own.max_deg)};
  }
  state.counters["tets"] = n_tets;
  state.counters["transitions"] = n_transitions / n_tets;
  state.counters["build_us_per_leaf"] = 1e6 * build / static_cast<double>(mesh->n_leaves());
  state.counters["build_us_per_tet"] = 1e6 * build / n_tets;
  state.counters["star_us"] = 1e6 * stars / n_vertices;
  state.counters["link_us"] = 1e6 * links / n_vertices;
  state.counters["bytes_per_tet"] = static_cast<double>(mesh->n_bytes()) / n_tets;
  state.counters["bytes_per_vertex"] = static_cast<double>(mesh->n_bytes()) / n_vertices;
  state.counters["least_Q"] = least_q;
  state.counters["least_deg"] = angles.min_deg;
  state.counters["greatest_deg"] = angles.max_deg;
}
BENCHMARK(graded_background)
    ->ArgNames({"growth_percent", "sweeps"})
    ->ArgsProduct({{15, 40}, {0, 8}})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

/// A sphere or a torus that is `growth` times as fine on one side, anywhere in the octree.
struct GradedBody {
  testing::AnalyticDomain domain;
  BackgroundMesh background;
};

GradedBody graded_body(bool is_torus, double h, double growth, const Vec3& centre) {
  testing::AnalyticDomain domain = is_torus ? testing::torus() : testing::sphere();
  domain.psi = [psi = domain.psi, centre](const Vec3& x, Vec3* g, Mat3* H) { return psi(x - centre, g, H); };
  domain.box = Box(domain.box.min() - Vec3::Constant(.1), domain.box.max() + Vec3::Constant(.1));
  const auto distance = [=](const Vec3& x) {
    const Vec3 y = x - centre;
    return is_torus ? std::hypot(std::hypot(y.x(), y.y()) - 1, y.z()) - .4 : y.norm() - 1;
  };
  Grading grading;
  grading.box = domain.box;
  grading.finest = h;
  grading.size = [=](const Vec3& x, double half) {
    const double reach = std::sqrt(3.) * half, way = is_torus ? 2.4 : 1.5;
    const Vec3 fine = centre + (is_torus ? Vec3(1.4, 0, 0) : Vec3(0, 0, 1));
    const double d = std::max(0., (x - fine).norm() - reach - .1);
    const double on_surface = h * std::min(1 + (growth - 1) * d / way, growth);
    return on_surface + .5 * std::max(0., std::abs(distance(x)) - reach - on_surface);
  };
  grading.wanted = [=](const Vec3& x, double half) { return distance(x) < (std::sqrt(3.) + 6) * half; };
  return {std::move(domain), BackgroundMesh(GradedMesh(grading))};
}

/// What the weights of costs by angles do before repair: of 1e4 tets at the boundary, those with Q below .76; the least
/// Q of each body, in the mean.
void graded_costs(benchmark::State& state) {
  const auto faces = .1F * static_cast<float>(state.range(0)), tets = .01F * static_cast<float>(state.range(1));
  std::mt19937 random(8);
  std::uniform_real_distribution<> offset(-.1, .1);
  std::vector<GradedBody> bodies;
  for (int k = 0; k < 9; ++k) {
    const double h = (k % 3 == 0 ? .04 : k % 3 == 1 ? .03 : .05) * (1 + 3 * offset(random));
    const double x = offset(random), y = offset(random), z = offset(random);
    bodies.push_back(graded_body(k % 3 == 2, h, k % 3 == 1 ? 8 : 4, Vec3(x, y, z)));
  }
  double bad = 0, at_boundary = 0, least = 0;
  for (auto _ : state) {
    for (const GradedBody& body : bodies) {
      const auto links = VertexLinks::listed(body.background);
      const StarCostTable costs(links->topologies(), [&](int bv, int nt) {
        const float d = static_cast<float>(bv) - 5.5F, more = std::max(0.F, static_cast<float>(nt) - 13);
        return faces * d * d + tets * more * more;
      });
      UmParams params;
      params.fast.repair.max_tries = 0;
      params.fast.classification.costs = &costs;
      const UmResult made = universal_mesh(body.background, body.domain, params);
      std::vector<bool> positive(made.final.size());
      for (const int v : made.submesh.positive_vertices) positive[static_cast<std::size_t>(v)] = true;
      double worst = 1;
      for (const Tet& t : made.submesh.mesh.C) {
        const double q = mean_ratio(made.final[t[0]], made.final[t[1]], made.final[t[2]], made.final[t[3]]);
        worst = std::min(worst, q);
        bad += q < .76;
        at_boundary += std::any_of(t.begin(), t.end(), [&](int v) { return positive[static_cast<std::size_t>(v)]; });
      }
      least += worst / static_cast<double>(bodies.size());
    }
  }
  state.counters["bad_of_1e4"] = 1e4 * bad / at_boundary;
  state.counters["least_q"] = least;
}
BENCHMARK(graded_costs)
    ->ArgNames({"faces_tenths", "tets_hundredths"})
    ->ArgsProduct({{0, 10, 20, 40}, {0, 10, 20, 40}})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

/// A sphere that is four times as fine on one side, from 50,000 to 5 million tets: CPU of the background and the choice
/// of its tets as a share of all; of all by boundary face; and tets a second on one core.
void graded_growth(benchmark::State& state) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const double h = 1e-4 * static_cast<double>(state.range(0));
  double choice = 0, all = 0, n_tets = 0, n_faces = 0, least = 1;
  for (auto _ : state) {
    double cpu = cpu_seconds();
    const GradedBody body = graded_body(false, h, 4, Vec3::Zero());
    ChosenSubmesh chosen = choose_submesh(body.background, body.domain);
    choice = cpu_seconds() - cpu;
    const UmResult made = fit_submesh(body.background, body.domain, {}, std::move(chosen));
    all = cpu_seconds() - cpu;
    n_tets = static_cast<double>(made.submesh.mesh.C.size());
    n_faces = static_cast<double>(made.submesh.positive_faces.size());
    for (const Tet& t : made.submesh.mesh.C) {
      least = std::min(least, mean_ratio(made.final[t[0]], made.final[t[1]], made.final[t[2]], made.final[t[3]]));
    }
  }
  state.counters["tets"] = n_tets;
  state.counters["faces"] = n_faces;
  state.counters["choice_share"] = choice / all;
  state.counters["us_per_face"] = 1e6 * all / n_faces;
  state.counters["ktets_per_s"] = 1e-3 * n_tets / all;
  state.counters["least_q"] = least;
}
BENCHMARK(graded_growth)
    ->ArgNames({"h_1e-4"})
    ->ArgsProduct({{440, 210, 100, 62}})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

/// Local flips on a sphere that is four times as fine on one side, by the share that the worst new tet has to promise:
/// tries, kept operations, and the least Q.
void flips(benchmark::State& state) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const GradedBody body = graded_body(false, .021, 4, Vec3::Zero());
  UmParams params;
  params.fast.flips_follow = true;
  const UmResult before = universal_mesh(body.background, body.domain, params);
  LocalFlipParams of_flips;
  of_flips.promising = 1e-2 * static_cast<double>(state.range(0));
  LocalFlipReport report;
  double least = 1;
  for (auto _ : state) {
    UmResult made = before;
    report = flip_submesh(body.domain, .021, of_flips, made);
    for (const Tet& t : made.submesh.mesh.C)
      least = std::min(least, mean_ratio(made.final[t[0]], made.final[t[1]], made.final[t[2]], made.final[t[3]]));
  }
  state.counters["tries"] = static_cast<double>(report.tries);
  state.counters["kept"] = static_cast<double>(report.n_removed_edges + report.n_collapsed + report.n_smoothed);
  state.counters["below_target"] = static_cast<double>(report.n_below);
  state.counters["least_q"] = least;
}
BENCHMARK(flips)->ArgName("promising_percent")->Arg(40)->Arg(60)->Arg(80)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace

BENCHMARK_MAIN();
