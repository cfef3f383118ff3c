#include "pipeline/output/run_prediction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "body/edges/edged_body.h"
#include "body/scan/cloud_preparation.h"
#include "body/scan/fitted_domain.h"
#include "body/scan/level_set_fit.h"
#include "body/sizing/background_choice.h"
#include "body/sizing/edge_length.h"
#include "mesh/sizes/body_size.h"
#include "pipeline/domain/body_options.h"
#include "reconstruct/cloud/cloud_arrays.h"
#include "reconstruct/cloud/neighbours/morton_order.h"
#include "reconstruct/solve/resolution.h"

namespace umtet {
namespace {

// Measured for whole runs with one thread: the clouds of data/clouds, and ellipsoids of 0.05 to 1 M points with 0.1 to
// 4 M tets (tests/bench/ellipsoid_cloud.py). tests/examples/cluster_test.py checks the former.
constexpr double kSecondsPerPoint = 14e-6, kSecondsPerTet = 3.5e-6, kSecondsOfStart = .2;
constexpr double kBytesPerPoint = 700, kBytesOfStart = 45e6;
// The memory per tet by which a run decides whether it may begin (pipeline/case/memory.cpp).
constexpr double kBytesPerTet = 500;

// With sharp edges most of the time is spent on flips: 19 to 80 microseconds per tet of a cube, quartet's joint and
// block, and a plate as thick as an edge (`umtet run`).
constexpr double kSecondsPerEdgedTet = 40e-6;

RunCost cost(double n_points, double n_tets) {
  return {n_tets, kSecondsOfStart + kSecondsPerPoint * n_points + kSecondsPerTet * n_tets,
          (kBytesOfStart + kBytesPerPoint * n_points + kBytesPerTet * n_tets) / 1e6};
}

// With this many samples, a surface whose area is the square of its diagonal has 3.7 spacings along an edge of the
// default mesh, so psi contains the data by which h is chosen. The fit of more samples takes seconds.
constexpr std::size_t kMostFitted = 60'000;

/// Keeps samples evenly along a space-filling curve.
void keep_few(OrientedPointCloud& cloud) {
  const std::size_t n = cloud.points.size(), step = (n + kMostFitted - 1) / kMostFitted;
  if (step < 2) return;
  sort_in_space(cloud);
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < n; i += step) kept.push_back(static_cast<std::uint32_t>(i));
  keep_samples(cloud, kept);
}

/// Returns the largest possible size of the body.
BodySize body_of(const CloudSurvey& survey, double area) {
  const double ball = std::pow(area, 1.5) / (6 * std::sqrt(std::numbers::pi));
  const double box = (survey.high - survey.low).prod();
  const double most = box > 0 ? std::min(ball, box) : ball;
  const double given = std::abs(survey.volume);
  return {.volume = survey.has_normals && survey.consistency >= SurveyParams().consistent && given > 0
                        ? std::min(given, most)
                        : most,
          .area = area};
}

/// Returns whether h follows from the samples: --h and --tets take precedence, and curvature and the walls of a box are
/// not known.
bool is_known(const Parameters& parameters) {
  const MeshParameters& p = parameters.mesh();
  return !background_file(parameters) && !p.complement && (p.max_deviation == 0 || p.h > 0 || p.tets > 0);
}

}  // namespace

RunPrediction predict_run(const CloudSurvey& survey, double area, const Parameters& parameters) {
  const MeshParameters& p = parameters.mesh();
  const BodySize body = body_of(survey, area);
  const ClassificationSource source = classification_source(body_options(parameters));
  const Tiling& tiling = is_known(parameters) && p.background != "graded" ? tiling_of(p) : a15();
  const auto max_tets = static_cast<double>(p.max_tets);
  const auto h_of = [&](double n) { return h_for_tets(tiling, body, n, source); };
  RunPrediction run;
  if (!is_known(parameters)) {
    run.h = h_of(max_tets);
  } else if (p.tets > 0) {
    run.h = h_of(static_cast<double>(p.tets));
  } else if (p.h > 0) {
    run.h = p.h;
  } else {
    const double thin = survey.thickness ? (*survey.thickness)[0] : std::numeric_limits<double>::infinity();
    run.h =
        edge_length_by(kMeshEdge * survey.diagonal, thin, [&] { return h_of(static_cast<double>(kTetsOfLargeMesh)); });
    run.h = std::max({run.h, h_of(max_tets), survey.noise / kMostNoise});
  }
  return prediction_of(run.h, expected_tets(tiling, body, run.h, source), static_cast<double>(survey.n_points),
                       parameters);
}

RunPrediction predict_run(CloudFile scan, const std::filesystem::path& file, const Parameters& parameters,
                          const Context& context) {
  const auto n_points = static_cast<double>(scan.cloud.points.size());
  const BodyOptions options = body_options(parameters);
  keep_few(scan.cloud);
  PreparedCloud prepared = prepare_cloud(std::move(scan), file.string(), options);
  LevelSetFit fit = fit_level_set(prepared.cloud, std::move(prepared.near), options, context);
  Domain domain =
      fitted_domain(std::move(fit.psi), std::move(prepared.cloud), fit.report, parse_box(parameters.mesh().box));
  domain.complement = parameters.mesh().complement;
  BackgroundChoice background(options, domain);
  const double h = background.edge_length(domain, context).h;
  RunPrediction run = prediction_of(h, background.expected_tets(domain, h), n_points, parameters);
  run.is_graded = background.is_graded();
  return run;
}

RunPrediction predict_run(const EdgedTriangles& edged, const Parameters& parameters, const Context& context) {
  Domain domain =
      edged_domain(edged.triangles, edged.body, {}, edged.shift, parse_box(parameters.mesh().box), parameters.mesh().h);
  BackgroundChoice background(body_options(parameters), domain);
  const double h = background.edge_length(domain, context).h, n_tets = background.expected_tets(domain, h);
  RunPrediction run = prediction_of(h, n_tets, 0, parameters);
  for (RunCost* c : {&run.expected, &run.most}) c->seconds += kSecondsPerEdgedTet * n_tets;
  run.is_graded = background.is_graded();
  return run;
}

RunPrediction prediction_of(double h, double n_tets, double n_points, const Parameters& parameters) {
  const MeshParameters& p = parameters.mesh();
  const auto max_tets = static_cast<double>(p.max_tets);
  n_tets = std::max(1., n_tets);
  RunPrediction run;
  run.h = h;
  run.expected = cost(n_points, n_tets);
  // All meshes together have p.effort times the tets of the first mesh; none has more than mesh.max_tets.
  const double all = std::max(1., p.effort) * n_tets;
  run.most = cost(n_points, all);
  run.most.n_tets = std::min(all, std::max(n_tets, max_tets));
  run.most.memory_MB = cost(n_points, run.most.n_tets).memory_MB;
  return run;
}

namespace {

Json to_json(const RunCost& cost) {
  return {{"n_tets", std::round(cost.n_tets)}, {"seconds", cost.seconds}, {"memory_MB", cost.memory_MB}};
}

}  // namespace

Json to_json(const RunPrediction& prediction) {
  Json json = {{"h", prediction.h},
               {"graded", prediction.is_graded},
               {"expected", to_json(prediction.expected)},
               {"most", to_json(prediction.most)}};
  if (!prediction.obstacle.empty()) json["obstacle"] = prediction.obstacle;
  return json;
}

std::string prediction_text(const RunPrediction& run) {
  std::string out;
  if (!run.obstacle.empty()) out += fmt::format("a run     is likely to end without a mesh: {}\n", run.obstacle);
  return out + fmt::format(
                   "{}about {:.2g} tets {} {:.3g}: {:.2g} s with one thread, {:.0f} MB; at most {:.2g} s, {:.0f} MB\n",
                   run.obstacle.empty() ? "a run     " : "          else ", run.expected.n_tets,
                   run.is_graded ? "with edges that follow the body, from" : "at h =", run.h, run.expected.seconds,
                   run.expected.memory_MB, run.most.seconds, run.most.memory_MB);
}

}  // namespace umtet
