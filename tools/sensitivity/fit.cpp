#include "tools/sensitivity/fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mesh/classification/configuration_costs.h"
#include "mesh/classification/tables/a15.h"
#include "mesh/core/tet_quality.h"
#include "mesh/fast/defects/patch_state.h"
#include "mesh/fast/fast_mesh.h"
#include "mesh/implicit/closest_point.h"
#include "mesh/implicit/surface_distance.h"
#include "mesh/sizes/body_size.h"
#include "mesh/submesh/assemble_submesh.h"
#include "mesh/submesh/linked_active_layer.h"
#include "tools/star_costs/random.h"

namespace umtet::sensitivity {

// A tenth of the differences in quality that show in a histogram, and work that shows on a clock.
const std::array<MeasureKind, kMeasures> kMeasureKinds = {{{"failed", false, false, false, .005},
                                                           {"left", false, false, false, 2},
                                                           {"below", false, false, false, 1},
                                                           {"least_q", true, false, false, .001},
                                                           {"quantile", true, false, false, .0005},
                                                           {"misaligned", false, false, false, 2},
                                                           {"folded_over", false, false, false, 1},
                                                           {"not_manifold", false, false, false, 1},
                                                           {"chordal", false, false, false, .2},
                                                           {"farthest", false, false, false, .003},
                                                           {"solves", false, true, true, 3},
                                                           {"patches", false, false, true, 30},
                                                           {"psi", false, true, true, 3},
                                                           {"changed", false, false, true, .1}}};

namespace {

constexpr int kSteps = 3;         // of a moving body
constexpr double kStep = .25;     // cells
constexpr double kPadding = 2;    // h around a body
constexpr double kBehind = 1e-3;  // h
constexpr double kPerHundredThousand = 1e5;

/// In mean edges.
double cell_edge(const Tiling& tiling) { return tiling.period[0] / tiling.mean_edge; }

BackgroundMesh background_of(const Body& body) {
  const double h = h_for_tets(a15(), body, body.box, body.n_tets), cell = cell_edge(a15()) * h;
  const Vec3 padding = Vec3::Constant(kPadding * h + kSteps * kStep * cell);
  return {a15(), Box(body.box.min() - padding - cell * body.offset, body.box.max() + padding), h};
}

/// Points of psi = 0 about an edge apart. psi < 0 behind them: sheets of |psi| are no boundary.
std::vector<Vec3> feet_of(const Body& body, const BackgroundMesh& background) {
  const double h = background.h();
  const ImplicitFunctionRef psi = body;
  std::vector<Vec3> feet;
  for (std::int64_t v = 0; v < background.n_vertices(); ++v) {
    const Vec3 x = background.position(v);
    if (!body.box.contains(x)) continue;
    Vec3 g;
    const double value = psi.value(x, g);
    if (!(std::abs(value) <= g.norm() * h)) continue;
    const ClosestPoint foot = closest_point(psi, x, h, {});
    if (!foot.converged || std::abs(foot.t) > h) continue;
    if (psi.value(foot.point - kBehind * h * psi.gradient(foot.point).normalized()) < 0) feet.push_back(foot.point);
  }
  return feet;
}

double share(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

/// Tets of the layer below the target, and those with a boundary vertex.
double left_below(const ActiveLayer& layer, double target) {
  std::size_t n_below = 0, n_at_boundary = 0;
  for (const Tet& t : layer.C) {
    n_below += mean_ratio({layer.V, {}}, t) < target;
    n_at_boundary +=
        std::any_of(t.begin(), t.end(), [&](int i) { return layer.role[i] == ActiveLayer::Role::Boundary; });
  }
  return kPerHundredThousand * share(n_below, n_at_boundary);
}

std::size_t tets_at_boundary(const Submesh& submesh) {
  std::vector<bool> is_positive(submesh.mesh.V.size());
  for (const int i : submesh.positive_vertices) is_positive[static_cast<std::size_t>(i)] = true;
  std::size_t n = 0;
  for (const Tet& t : submesh.mesh.C) n += std::any_of(t.begin(), t.end(), [&](int i) { return is_positive[i]; });
  return n;
}

void measure_tets(const Submesh& submesh, const std::vector<Vec3>& V, double target, Measured& m) {
  std::vector<double> quality;
  for (const Tet& t : submesh.mesh.C) quality.push_back(mean_ratio(V[t[0]], V[t[1]], V[t[2]], V[t[3]]));
  std::sort(quality.begin(), quality.end());
  const auto below =
      static_cast<std::size_t>(std::lower_bound(quality.begin(), quality.end(), target) - quality.begin());
  m[kLeastQ] = quality.front();
  m[kQuantile] = quality[quality.size() / 100];
  m[kBelow] = kPerHundredThousand * share(below, tets_at_boundary(submesh));
  m[kFailed] = quality.front() > 0 ? 0 : 1;
}

void measure_faces(const Subject& subject, ImplicitFunctionRef psi, const Submesh& submesh, const std::vector<Vec3>& V,
                   Measured& m) {
  const double h = subject.background.h();
  std::size_t misaligned = 0, folded_over = 0, evaluations = 0;
  double sum2 = 0;
  for (const Triangle& f : submesh.positive_faces) {
    const Vec3 &a = V[f[0]], &b = V[f[1]], &c = V[f[2]];
    const double cosine = normal_cosine(psi, a, b, c, h, evaluations);
    misaligned += cosine < kMisalignedCosine;
    folded_over += cosine < 0;
    Vec3 g;
    const double value = psi.value((a + b + c) / 3, g), e = value / (g.norm() * h);
    sum2 += e * e;
  }
  const std::size_t n = submesh.positive_faces.size();
  m[kMisaligned] = kPerHundredThousand * share(misaligned, n);
  m[kFoldedOver] = kPerHundredThousand * share(folded_over, n);
  m[kChordal] = 1e3 * std::sqrt(sum2 / static_cast<double>(n));
  double farthest = 0;
  for (const double d : SurfaceDistance(V, submesh.positive_faces).distances(subject.feet)) {
    farthest = std::max(farthest, d);
  }
  m[kFarthest] = farthest / h;
}

Measured failed() {
  Measured m{};
  m[kFailed] = 1;
  return m;
}

/// The classification parameters with star costs; `costs` keeps those that are not the tiling's.
ClassificationParams classification_of(const Settings& settings, const ConfigurationCosts& of_tiling,
                                       std::optional<StarCostTable>& costs) {
  ClassificationParams params = settings.fast.classification;
  if (settings.good) costs.emplace(of_tiling.links, kA15ConfigurationQualities, *settings.good);
  params.costs = costs ? &*costs : &of_tiling.costs;
  return params;
}

}  // namespace

Subject subject(Body body) {
  BackgroundMesh background = background_of(body);
  std::size_t evaluations = 0;
  IdSet negative = inside_vertices(background, body, evaluations);
  std::vector<Vec3> feet = feet_of(body, background);
  return {std::move(body), std::move(background), std::move(negative), std::move(feet)};
}

Measured fit(const Subject& subject, const Settings& settings, std::vector<Vec3>* vertices) {
  const BackgroundMesh& background = subject.background;
  const ImplicitFunctionRef psi = subject.body;
  const ConfigurationCosts& of_tiling = *configuration_costs(background.tiling());
  std::optional<StarCostTable> costs;
  const ClassificationParams classification = classification_of(settings, of_tiling, costs);
  const VertexLinks links(background, of_tiling.links);
  IdSet inside = subject.negative;
  const ClassificationReport classified = classify_vertices(background, links, psi, classification, inside);
  std::size_t evaluations = classified.psi_evaluations;
  BackgroundLayer cut = linked_active_layer(background, links, inside, settings.fast.layers);
  PNormSmoother smoother(cut.layer);
  const ProjectionReport projection = project(smoother, psi, settings.fast.projection);
  if (!projection.not_arrived.empty()) return failed();
  smoother.enqueue_all();
  const SmoothingReport smoothing = smoother.run(psi, settings.fast.smoothing);
  TangentialRelaxationParams relaxation = settings.relaxation;
  relaxation.least_quality = settings.fast.smoothing.target;
  evaluations +=
      projection.psi_evaluations + smoothing.psi_evaluations +
      relax_tangentially(smoother, inside_of(cut, inside), psi, relaxation, settings.fast.smoothing).psi_evaluations;
  Measured m{};
  m[kLeft] = left_below(cut.layer, settings.fast.smoothing.target);
  RepairParams repair_params = settings.fast.repair;
  repair_params.target = std::min(repair_params.target, of_tiling.repair_target);
  repair_params.reach = std::min(repair_params.reach, of_tiling.repair_reach);
  const RepairReport repaired = repair(background, links, psi, classification, repair_params, cut, inside);

  const Submesh submesh = emit_submesh(background, inside);
  std::vector<Vec3> V = submesh.mesh.V;
  const auto put = [&](std::int64_t id, const Vec3& x) {
    const auto& ids = submesh.background_vertex;
    const auto at = std::lower_bound(ids.begin(), ids.end(), id);
    if (at != ids.end() && *at == id) V[static_cast<std::size_t>(at - ids.begin())] = x;
  };
  for (std::size_t v = 0; v < cut.layer.V.size(); ++v) put(cut.background_vertex[v], cut.layer.V[v]);
  for (const auto& [id, x] : repaired.moved) put(id, x);
  measure_tets(submesh, V, settings.fast.smoothing.target, m);
  measure_faces(subject, psi, submesh, V, m);
  m[kNotManifold] = kPerHundredThousand * share(classified.not_manifold.size(), submesh.positive_vertices.size());
  m[kSolves] = static_cast<double>(projection.smoothing.solves + smoothing.solves);
  m[kPatches] = kPerHundredThousand * share(repaired.tries, tets_at_boundary(submesh));
  m[kPsi] = static_cast<double>(evaluations + repaired.psi_evaluations);
  if (vertices) *vertices = std::move(V);
  return m;
}

Measured fit_moving(const Subject& subject, const Settings& settings) {
  const BackgroundMesh& background = subject.background;
  star_costs::Random random(subject.feet.size());  // a direction for each body, the same with all settings
  const Vec3 step = kStep * cell_edge(background.tiling()) * background.h() * random.rotation().col(0);
  FastMemory memory;
  Body body = subject.body;
  Measured m{};
  IdSet before(0);
  for (int k = 0; k <= kSteps; ++k) {
    body.psi = [&psi = subject.body.psi, shift = k * step](const Vec3& x, Vec3* g, Mat3* H) {
      return psi(x - shift, g, H);
    };
    std::size_t evaluations = 0;
    const UmResult result =
        fast_mesh(background, body, {}, settings.fast, {}, inside_vertices(background, body, evaluations), memory);
    if (result.status != UmStatus::Success) return failed();
    if (k > 0) {
      std::size_t changed = 0;
      for (std::size_t w = 0; w < before.n_words(); ++w) {
        changed += static_cast<std::size_t>(std::popcount(before.word(w) ^ memory.inside.word(w)));
      }
      Measured now{};
      measure_tets(result.submesh, result.final, settings.fast.smoothing.target, now);
      now[kChanged] = 100 * share(changed, result.submesh.positive_vertices.size());
      now[kPsi] = static_cast<double>(result.n_psi_evaluations);
      for (std::size_t i = 0; i < kMeasures; ++i) m[i] += now[i] / kSteps;
    }
    before = memory.inside;
  }
  return m;
}

bool is_fast_mesh(const Subject& subject, const Settings& settings) {
  std::vector<Vec3> V;
  const Measured m = fit(subject, settings, &V);
  const UmResult result = fast_mesh(subject.background, subject.body, {}, settings.fast,
                                    classified_submesh(subject.background, subject.body, {}, settings.fast));
  return m[kFailed] != 0 ? result.status != UmStatus::Success : result.final == V;
}

}  // namespace umtet::sensitivity
