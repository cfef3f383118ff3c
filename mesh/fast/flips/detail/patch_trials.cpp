#include "mesh/fast/flips/detail/patch_trials.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "mesh/fast/smoothing/all_vertex_smoothing.h"
#include "mesh/fast/smoothing/ring_newton.h"
#include "mesh/submesh/active_layer.h"

namespace umtet::detail {
namespace {

using Operation = FlipCandidate::Operation;
using Stratum = VertexStratum;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The sum over a patch is of target / Q to the power of 18; an operation has to lower it by this share. The sum counts
// the worst tet most, and allows others to become a little worse.
constexpr double kLeastGain = .02;
// The least Q of a patch may fall by this much where the sum falls.
constexpr double kLostQuality = .003;
// In the last pass it is enough that the worst tet reaches the target, or rises by this much while the sum does not.
constexpr double kLeastRaise = 5e-4;
// Sweeps over the vertices of a patch, at most.
constexpr int kSweeps = 6;
constexpr double kVertexGain = 2e-4;  // of the norm of 1/Q of a ring: less is no move
// The same of a step of all vertices, along sharp edges: with 1e-5 a try takes half as long again, and the least Q is
// the same within .003 (`umtet run` of cube, joint, block, fandisk). Without edges it falls from .780 to .775 (skull).
constexpr double kStepGain = 1e-5, kStepGainAtEdges = 1e-4;
// In edges: the centroid of a new boundary face may be this far from psi = 0, or as far as the worst of the patch was.
constexpr double kFaceDistance = .2;

double power18(double x) {
  const double x2 = x * x, x4 = x2 * x2, x8 = x4 * x4;
  return x8 * x8 * x2;
}

}  // namespace

PatchTrials::PatchTrials(const ChangingMesh& mesh, ImplicitFunctionRef psi, const LocalFlipParams& params,
                         LocalFlipReport& report)
    : mesh_(mesh),
      local_(mesh.V.size(), -1),
      psi_(psi),
      params_(params),
      report_(report),
      good_f_(f_of_quality(std::min(.999, params.target + .02))) {
  measure_edges();
}

bool PatchTrials::operator()(const FlipCandidate& c, bool is_last, FlipPatch& patch) {
  ++report_.tries;
  list_tets(c);
  std::vector<Tet> before;
  std::vector<int> regions;
  for (const int t : patch_tets_) {
    before.push_back(mesh_.C[t]);
    if (mesh_.has_regions()) regions.push_back(mesh_.region[t]);
  }
  const PatchMeasure old = measured(patch_of(before, std::move(regions)));
  std::vector<Tet> after = c.new_tets;
  regions = c.new_regions;
  kept_tets_.clear();
  for (const int t : patch_tets_) {
    if (std::binary_search(c.old_tets.begin(), c.old_tets.end(), t)) continue;
    kept_tets_.push_back(t);
    after.push_back(mesh_.C[t]);
    if (mesh_.has_regions()) regions.push_back(mesh_.region[t]);
  }
  patch = patch_of(after, std::move(regions));
  if (c.operation != Operation::SmoothAll) {
    shape(patch);
    if (!is_last) return is_better(measured(patch), old, is_last);
    // At sharp edges a cube ends at .785 instead of .777 where the first step that is good enough is kept; a smooth
    // body at .777 instead of .780 (skull).
    if (mesh_.stratified && is_better(measured(patch), old, is_last)) return true;
  }
  shape_at_once(patch, mesh_.stratified ? old.least - kLostQuality : 0);
  return is_better(measured(patch), old, is_last);
}

void PatchTrials::measure_edges() {
  edge_.assign(mesh_.V.size(), 0);
  std::vector<int> n(mesh_.V.size(), 0);
  for (const Tet& t : mesh_.C)
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j) {
        const double length = (mesh_.V[t[i]] - mesh_.V[t[j]]).norm();
        edge_[t[i]] += length, edge_[t[j]] += length;
        ++n[t[i]], ++n[t[j]];
      }
  for (std::size_t v = 0; v < mesh_.V.size(); ++v) edge_[v] /= std::max(1, n[v]);
}

/// The vertices of the new tets move; a patch contains all tets at a vertex that moves.
void PatchTrials::list_tets(const FlipCandidate& c) {
  moving_.clear();
  for (const Tet& t : c.new_tets)
    for (const int v : t)
      if (mesh_.moves(v)) moving_.push_back(v);
  std::sort(moving_.begin(), moving_.end());
  moving_.erase(std::unique(moving_.begin(), moving_.end()), moving_.end());
  patch_tets_.clear();
  for (const int v : moving_)
    for (const int t : mesh_.incidence.of(v)) patch_tets_.push_back(t);
  for (const int t : c.old_tets) patch_tets_.push_back(t);
  std::sort(patch_tets_.begin(), patch_tets_.end());
  patch_tets_.erase(std::unique(patch_tets_.begin(), patch_tets_.end()), patch_tets_.end());
}

bool PatchTrials::is_better(const PatchMeasure& made, const PatchMeasure& old, bool is_last) const {
  const bool has_less = made.sum < (1 - kLeastGain) * old.sum && made.least >= old.least - kLostQuality;
  // A misaligned face may bring in a patch whose tets are good already: with strata that is no reason to keep an
  // operation, which could go on for ever.
  const bool has_reached = made.least >= params_.target && (!mesh_.stratified || old.least < params_.target);
  const bool has_raised = is_last && (has_reached || (made.sum <= old.sum && made.least > old.least + kLeastRaise));
  return (has_less || has_raised) && made.shortest >= std::min(params_.shortest, old.shortest) &&
         made.longest <= std::max(params_.longest, old.longest) &&
         made.least_cosine >= std::min(kAligned, old.least_cosine) &&
         made.farthest <= std::max(kFaceDistance, old.farthest);
}

FlipPatch PatchTrials::patch_of(const std::vector<Tet>& tets, std::vector<int> region) {
  FlipPatch patch;
  patch.region = std::move(region);
  patch.C.reserve(tets.size());
  for (const Tet& t : tets) {
    Tet l{};
    for (int k = 0; k < 4; ++k) {
      if (local_[t[k]] < 0) {
        local_[t[k]] = static_cast<int>(patch.vertices.size());
        patch.vertices.push_back(t[k]);
        patch.V.push_back(mesh_.V[t[k]]);
        patch.moves.push_back(std::binary_search(moving_.begin(), moving_.end(), t[k]) ? 1 : 0);
      }
      l[k] = local_[t[k]];
    }
    patch.C.push_back(l);
  }
  for (const int v : patch.vertices) local_[v] = -1;
  patch.ring.resize(patch.vertices.size());
  for (const Tet& t : patch.C) {
    for (int k = 0; k < 4; ++k)
      if (patch.moves[t[k]]) patch.ring[t[k]].push_back({t[kTetFace[k][0]], t[kTetFace[k][1]], t[kTetFace[k][2]]});
  }
  return patch;
}

/// Moves the vertices of a patch until all its tets reach the target or none gains any more.
void PatchTrials::shape(FlipPatch& patch) {
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    bool has_moved = false, is_good = true;
    for (std::size_t v = 0; v < patch.V.size(); ++v) {
      if (!patch.moves[v] || patch.ring[v].size() > kMaxRing) continue;
      OneRing ring(patch.V[v], patch.V, patch.ring[v]);
      if (ring.f_here >= good_f_) continue;
      is_good = false;
      silence_padding(ring);
      has_moved |= solve(patch, v, ring);
    }
    if (is_good || !has_moved) return;
  }
}

/// The same where single vertices gain nothing. It ends early where the least Q of the patch will not be the needed
/// one.
void PatchTrials::shape_at_once(FlipPatch& patch, double needed) {
  ActiveLayer layer;
  layer.V = patch.V;
  layer.C = patch.C;
  for (std::size_t v = 0; v < patch.V.size(); ++v) {
    const bool is_on_boundary = mesh_.stratum[patch.vertices[v]] == Stratum::Boundary;
    layer.role.push_back(!patch.moves[v]  ? ActiveLayer::Role::Fixed
                         : is_on_boundary ? ActiveLayer::Role::Boundary
                                          : ActiveLayer::Role::Inner);
    layer.local_h.push_back(edge_[patch.vertices[v]]);
    if (!mesh_.stratified) continue;
    layer.stratum.push_back(mesh_.stratified->of[patch.vertices[v]]);
    layer.ball.push_back(patch.moves[v] && is_on_boundary ? ball_of(patch.vertices[v]) : BallOnPatch{});
  }
  if (mesh_.stratified) layer.strata = mesh_.stratified->strata;
  report_.psi_evaluations +=
      smooth_all_vertices(layer, psi_, params_.target, needed, mesh_.stratified ? kStepGainAtEdges : kStepGain)
          .psi_evaluations;
  patch.V = std::move(layer.V);
}

bool PatchTrials::solve(FlipPatch& patch, std::size_t v, const OneRing& ring) {
  const int vertex = patch.vertices[v];
  const double h = edge_[vertex];
  const Bar bar(ring, h, kVertexGain);
  Vec3& x = patch.V[v];
  if (mesh_.stratum[vertex] == Stratum::Inner) {
    const Displacement best = best_displacement(ring, bar, h, {});
    if (!best.passed(ring, bar)) return false;
    x += best.y;
    return true;
  }
  if (mesh_.stratified) return solve_on_stratum(vertex, ring, bar, x);
  Vec3 gradient;
  psi_.value(x, gradient);
  ++report_.psi_evaluations;
  const double norm = gradient.norm();
  if (!(norm > 0) || !std::isfinite(norm)) return false;
  Directions tangent{true, {}};
  tangent.tangents.col(0) = gradient.unitOrthogonal();
  tangent.tangents.col(1) = (gradient / norm).cross(tangent.tangents.col(0));
  const Displacement best = best_displacement(ring, bar, h, tangent);
  if (!best.passed(ring, bar)) return false;
  const ClosestPoint foot = closest_point(psi_, x + best.y, h, closest_point_);
  report_.psi_evaluations += static_cast<std::size_t>(foot.iterations);
  if (!foot.converged || !bar.passed(ring, foot.point - x)) return false;
  x = foot.point;
  return true;
}

/// A ball that contains the vertex in the mesh, if there is one.
[[gnu::noinline]] const BallOnPatch& PatchTrials::ball_of(int vertex) {
  if (ball_.empty()) ball_.resize(mesh_.V.size());
  BallOnPatch& ball = ball_[vertex];
  const Vec3& x = mesh_.V[vertex];
  if (ball.radius < 0 || (ball.radius > 0 && (x - ball.centre).norm() > ball.radius / 2))
    ball = mesh_.stratified->strata->ball_on_patch(mesh_.stratified->of[vertex], x, edge_[vertex]);
  return ball;
}

[[gnu::noinline]] bool PatchTrials::solve_on_stratum(int vertex, const OneRing& ring, const Bar& bar, Vec3& x) {
  const BoundaryStrata& strata = *mesh_.stratified->strata;
  const int stratum = mesh_.stratified->of[vertex];
  const double h = edge_[vertex];
  const FreeDirections free = strata.directions(stratum, x);
  ++report_.psi_evaluations;
  if (free.n == 0) return false;
  const Displacement best =
      best_displacement(ring, bar, h, {.plane = true, .tangents = free.tangents, .line = free.n == 1});
  Vec3 foot;
  if (!best.passed(ring, bar) || !strata.foot(stratum, x + best.y, h, foot, &ball_of(vertex))) return false;
  ++report_.psi_evaluations;
  if (!bar.passed(ring, foot - x)) return false;
  x = foot;
  return true;
}

PatchMeasure PatchTrials::measured(const FlipPatch& patch) {
  PatchMeasure m;
  for (const Tet& t : patch.C) {
    const double q = mean_ratio_of(patch.V, t);
    m.least = std::min(m.least, q);
    m.sum += q > 0 ? power18(params_.target / q) : kInfinity;
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j) {
        if (!patch.moves[t[i]] && !patch.moves[t[j]]) continue;
        const double mean = (edge_[patch.vertices[t[i]]] + edge_[patch.vertices[t[j]]]) / 2;
        const double ratio = (patch.V[t[i]] - patch.V[t[j]]).norm() / mean;
        m.shortest = std::min(m.shortest, ratio);
        m.longest = std::max(m.longest, ratio);
      }
  }
  if (m.sum < kInfinity) measure_faces(patch, m);
  return m;
}

/// Faces with a vertex that moves and one tet, or with two tets of different regions, as faces of the greater region.
/// The patch holds all tets at such a vertex.
void PatchTrials::measure_faces(const FlipPatch& patch, PatchMeasure& m) {
  faces_.clear();
  for (std::size_t k = 0; k < patch.C.size(); ++k) {
    const Tet& t = patch.C[k];
    for (const auto& f : kTetFace) {
      const Triangle face = {t[f[0]], t[f[1]], t[f[2]]};
      const bool is_candidate =
          std::all_of(face.begin(), face.end(),
                      [&](int v) { return mesh_.stratum[patch.vertices[v]] == Stratum::Boundary; }) &&
          std::any_of(face.begin(), face.end(), [&](int v) { return patch.moves[v] != 0; });
      if (!is_candidate) continue;
      Triangle key = face;
      std::sort(key.begin(), key.end());
      faces_.push_back({key, face, patch.region.empty() ? 0 : patch.region[k]});
    }
  }
  std::sort(faces_.begin(), faces_.end(), [](const Face& x, const Face& y) {
    return std::tie(x.key, x.region, x.face) < std::tie(y.key, y.region, y.face);
  });
  for (std::size_t k = 0; k < faces_.size(); ++k) {
    const bool has_next = k + 1 < faces_.size() && faces_[k + 1].key == faces_[k].key;
    const bool has_former = k > 0 && faces_[k - 1].key == faces_[k].key;
    if (patch.region.empty() ? has_next || has_former
                             : has_next || !has_former || faces_[k - 1].region == faces_[k].region)
      continue;
    const Triangle& f = faces_[k].face;
    const Vec3 &a = patch.V[f[0]], &b = patch.V[f[1]], &c = patch.V[f[2]];
    const Vec3 normal = (b - a).cross(c - a);
    Vec3 gradient;
    const Vec3 centroid = (a + b + c) / 3;
    const double value = mesh_.stratified && mesh_.has_regions()
                             ? mesh_.value_between(faces_[k].region, faces_[k - 1].region, centroid, gradient)
                         : mesh_.stratified
                             ? mesh_.value_on_patch({patch.vertices[f[0]], patch.vertices[f[1]], patch.vertices[f[2]]},
                                                    centroid, gradient)
                             : psi_.value(centroid, gradient);
    ++report_.psi_evaluations;
    const double slope = gradient.norm(), cosine = normal.dot(gradient) / (normal.norm() * slope);
    const double h = (edge_[patch.vertices[f[0]]] + edge_[patch.vertices[f[1]]] + edge_[patch.vertices[f[2]]]) / 3;
    if (!std::isfinite(cosine)) {
      m.least_cosine = -1;
      continue;
    }
    m.least_cosine = std::min(m.least_cosine, cosine);
    m.farthest = std::max(m.farthest, std::abs(value) / (slope * h));
    if (cosine < kAligned) m.sum += power18(params_.target / quality_of_cosine(params_.target, cosine));
  }
}

}  // namespace umtet::detail
