#include "mesh/fast/fast_mesh.h"

#include <oneapi/tbb/parallel_invoke.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "mesh/classification/classification.h"
#include "mesh/classification/configuration_costs.h"
#include "mesh/classification/manifold_boundary.h"
#include "mesh/fast/fitted_layer.h"
#include "mesh/fast/repair/step_back.h"
#include "mesh/fast/update/warm_start.h"
#include "mesh/submesh/assemble_submesh.h"
#include "mesh/submesh/assumptions.h"
#include "mesh/submesh/linked_active_layer.h"
#include "mesh/submesh/nothing_inside.h"
#include "mesh/submesh/walled_active_layer.h"
#include "mesh/submesh/walls.h"

namespace umtet {
namespace {

// The least gain of a smoothing step in a mesh that begins from the one before, where that of the parameters is less.
// It trades solves for quality: a mesh that begins near its solution spends most of them on small gains (moving_bench).
constexpr double kUpdateLeastGain = 6e-4;

class FastRun {
 public:
  FastRun(const BackgroundMesh& background, ImplicitFunctionRef psi, const SubmeshParams& submesh,
          const FastParams& params, const Context& context, std::shared_ptr<const VertexLinks> links = nullptr)
      : background_(background),
        psi_(psi),
        submesh_params_(submesh),
        params_(params),
        context_(context),
        costs_(submesh.background_boundary == BackgroundBoundary::Wall
                   ? std::nullopt
                   : background_costs(background, std::move(links))),
        classification_params_(params.classification),
        inside_(0) {
    if (costs_ && !classification_params_.costs) classification_params_.costs = &costs_->costs;
  }

  ChosenSubmesh choose(const std::vector<Vec3>& seeds) {
    if (find_inside(seeds) && classify() && !is_complete_) {
      SubmeshOutline outline = outline_submesh(background_, inside_);
      result_.submesh = std::move(outline.submesh);
      n_tets_ = outline.n_tets;
    }
    return chosen_submesh();
  }
  ChosenSubmesh chosen_submesh() {
    context_.report("submesh", 1);
    const bool is_whole = is_complete_ || result_.status != UmStatus::Success;
    return {.status = result_.status,
            .evidence = std::move(result_.evidence),
            .inside = std::move(inside_),
            .submesh = std::move(result_.submesh),
            .is_whole = is_whole,
            .walls = std::move(result_.walls),
            .manifold_flips = std::move(result_.manifold_flips),
            .links = costs_ ? costs_->links : nullptr,
            .n_tets = result_.status == UmStatus::Success ? n_tets_ : 0,
            .n_psi_evaluations = result_.n_psi_evaluations,
            .kept = {}};
  }
  /// As choose(), with what stays of a former mesh.
  ChosenSubmesh choose(const FormerMesh& former) {
    context_.report("search", 0);
    const FormerStates states = former_states(background_, *costs_->links, psi_, former, context_);
    result_.n_psi_evaluations += states.psi_evaluations;
    inside_ = states.inside;
    known_ = &states.cut;
    if (fits_background("") && classify()) {
      SubmeshOutline outline = outline_submesh(background_, inside_);
      result_.submesh = std::move(outline.submesh);
      n_tets_ = outline.n_tets;
    }
    known_ = nullptr;
    std::vector<KeptVertex> kept;
    if (is_classified_) {
      kept = kept_vertices(background_, *costs_->links, former, states, inside_);
      keep_flips(former, states);
    }
    ChosenSubmesh chosen = chosen_submesh();
    chosen.kept = std::move(kept);
    return chosen;
  }
  UmResult fit(ChosenSubmesh chosen) {
    kept_ = std::move(chosen.kept);
    inside_ = std::move(chosen.inside);
    is_classified_ = chosen.status == UmStatus::Success;
    is_complete_ = chosen.is_whole;
    result_ = result_of(std::move(chosen));
    if (is_classified_) fit();
    return finished();
  }
  UmResult operator()(IdSet inside, FastMemory& memory, const PsiValues& known) {
    if (!known.empty()) known_ = &known;
    inside_ = std::move(inside);
    negative_ = inside_;
    memory_ = &memory;
    memory.links = costs_ ? costs_->links : nullptr;
    memory.n_recalled = 0;
    const bool made = fits_background("") && classify();
    if (made) fit();
    UmResult result = finished();
    if (made) {
      remember(memory);
    } else {
      memory.moved.clear();
    }
    return result;
  }

 private:
  UmResult finished() {
    if (is_classified_) complete();
    if (result_.final.empty()) result_.final = result_.submesh.mesh.V;
    if (result_.projected.empty()) result_.projected = result_.final;
    return std::move(result_);
  }
  bool fail(UmStatus status, const UmEvidence& evidence) {
    result_.status = status;
    result_.evidence = evidence;
    return false;
  }
  bool find_inside(const std::vector<Vec3>& seeds);
  void keep_flips(const FormerMesh& former, const FormerStates& states);
  bool fits_background(const std::string& lost);
  void remember(FastMemory& memory);
  bool classify();
  bool check_walls();
  void complete();
  void relax(std::vector<Vec3>& projected);
  void fit();
  bool make_manifold(const std::vector<std::int64_t>& bad);
  std::vector<Vec3> coordinates(const std::vector<Vec3>& layer_V, Vec3 KeptVertex::*kept) const;
  void repair_classification();
  void measure_assumptions();

  const BackgroundMesh& background_;
  ImplicitFunctionRef psi_;
  const SubmeshParams& submesh_params_;
  const FastParams& params_;
  const Context& context_;
  std::optional<BackgroundCosts> costs_;        ///< none: inside is where psi < 0
  ClassificationParams classification_params_;  ///< with the costs
  UmResult result_;
  IdSet inside_;
  IdSet negative_{0};             ///< of update: psi < 0
  FastMemory* memory_ = nullptr;  ///< of the psi before
  const PsiValues* known_ = nullptr;
  BackgroundLayer layer_;
  std::vector<std::pair<std::int64_t, Vec3>> moved_;  ///< by repair, ascending
  std::vector<KeptVertex> kept_;                      ///< of a former mesh, ascending
  bool is_classified_ = false, is_complete_ = false;  ///< inside_ has been chosen, omega_h made of it
  std::size_t n_tets_ = 0;                            ///< of omega_h, as far as it is known
};

bool FastRun::find_inside(const std::vector<Vec3>& seeds) {
  std::string lost;
  context_.report("search", 0);
  if (submesh_params_.search == SubmeshSearch::FullLoop) {
    inside_ = inside_vertices(background_, psi_, result_.n_psi_evaluations, context_, submesh_params_.known);
  } else {
    CrawledVertices found = crawl_inside(background_, psi_, seeds, context_);
    inside_ = std::move(found.inside);
    result_.n_psi_evaluations = found.n_psi_evaluations;
    lost = text_of_lost_seeds(found.lost_seeds.size(), seeds.size());
  }
  return fits_background(lost);
}

bool FastRun::fits_background(const std::string& lost) {
  UmEvidence background_boundary{.what = "the domain reaches the boundary of the background mesh"};
  bool empty = true;
  for (std::size_t w = 0; w < inside_.n_words(); ++w) {
    const auto first = static_cast<std::int64_t>(64 * w);
    std::uint64_t bits = inside_.word(w);
    if (bits == 0) continue;
    empty = false;
    if (submesh_params_.background_boundary == BackgroundBoundary::Wall ||
        background_.is_off_boundary(first, first + 63))
      continue;
    for (; bits != 0; bits &= bits - 1) {
      const std::int64_t v = first + std::countr_zero(bits);
      if (background_.on_boundary(v) && background_boundary.count++ == 0) background_boundary.background_vertex = v;
    }
  }
  if (empty) {
    const NothingInside why = nothing_inside(background_, psi_, context_, lost);
    return fail(why.status, why.evidence);
  }
  if (background_boundary.count == 0) return true;
  background_boundary.where = background_.position(background_boundary.background_vertex);
  result_.submesh = emit_submesh(background_, inside_);
  return fail(UmStatus::DomainLeavesBackground, background_boundary);
}

bool FastRun::classify() {
  const IdSet* last = memory_ && !memory_->moved.empty() ? &memory_->inside : nullptr;
  if (costs_ && last && negative_ == memory_->negative) {
    inside_ = *last;  // psi has the sign it had at every vertex
  } else if (costs_) {
    const ClassificationReport report =
        classify_vertices(background_, *costs_->links, psi_, classification_params_, inside_, context_, last, known_);
    result_.n_psi_evaluations += report.psi_evaluations;
    if (!make_manifold(report.not_manifold)) return false;
  } else if (!make_manifold(vertices_not_manifold(background_, nullptr, inside_))) {
    return false;
  }
  is_classified_ = true;
  if (costs_) return true;
  complete();
  return submesh_params_.background_boundary != BackgroundBoundary::Wall || check_walls();
}

bool FastRun::make_manifold(const std::vector<std::int64_t>& bad) {
  ManifoldReport report =
      umtet::make_manifold(background_, costs_ ? costs_->links.get() : nullptr, psi_, classification_params_,
                           submesh_params_.background_boundary == BackgroundBoundary::Wall, bad, inside_, context_);
  result_.n_psi_evaluations += report.psi_evaluations;
  result_.manifold_flips = std::move(report.flips);
  if (bad.empty() || !inside_.is_empty_around(0, background_.n_vertices())) return true;
  return fail(UmStatus::EmptyDomain, {.what = "no body is left that h can show"});
}

/// Where the former mesh was made a manifold, and has stayed as it was.
void FastRun::keep_flips(const FormerMesh& former, const FormerStates& states) {
  for (ManifoldFlip flip : former.mesh.manifold_flips) {
    const std::int64_t key = former.background.key_of_vertex(flip.background_vertex);
    flip.background_vertex = background_.vertex_of_key(key);
    const bool stays = flip.background_vertex >= 0 && states.same.test(flip.background_vertex) &&
                       inside_.test(flip.background_vertex) == flip.is_filled;
    if (stays) result_.manifold_flips.push_back(flip);
  }
  std::sort(result_.manifold_flips.begin(), result_.manifold_flips.end(),
            [](const auto& a, const auto& b) { return a.background_vertex < b.background_vertex; });
}

bool FastRun::check_walls() {
  result_.walls = wall_faces(background_, result_.submesh);
  const UmEvidence near = boundary_near_walls(background_, result_.submesh);
  return near.count == 0 || fail(UmStatus::BoundaryNearWall, near);
}

/// omega_h of the inside vertices, if it has not been listed.
void FastRun::complete() {
  if (is_complete_) return;
  result_.submesh = {};  // before the tets need their memory
  result_.submesh = emit_submesh(background_, inside_);
  n_tets_ = result_.submesh.mesh.C.size();
  is_complete_ = true;
}

/// The vertices of omega_h with those of the layer at V, and the repaired ones where repair has put them.
/// @param kept  which place of the vertices that a former mesh has left
std::vector<Vec3> FastRun::coordinates(const std::vector<Vec3>& layer_V, Vec3 KeptVertex::*kept) const {
  std::vector<Vec3> V = result_.submesh.mesh.V;
  const auto& ids = result_.submesh.background_vertex;
  const auto put = [&, at = ids.begin()](std::int64_t id, const Vec3& x) mutable {
    while (at != ids.end() && *at < id) ++at;
    if (at != ids.end() && *at == id) V[at - ids.begin()] = x;
  };
  auto put_kept = put;
  for (const KeptVertex& k : kept_) put_kept(k.vertex, k.*kept);
  auto put_layer = put;
  for (std::size_t v = 0; v < layer_V.size(); ++v) put_layer(layer_.background_vertex[v], layer_V[v]);
  auto put_moved = put;
  for (const auto& [id, x] : moved_) put_moved(id, x);
  return V;
}

/// The places of the layer, and of what repair has moved.
void FastRun::remember(FastMemory& memory) {
  memory.moved.clear();
  const auto earlier = [](const auto& a, const auto& b) { return a.first < b.first; };
  for (std::size_t v = 0; v < layer_.layer.V.size(); ++v) {
    const std::pair<std::int64_t, Vec3> place = {layer_.background_vertex[v], layer_.layer.V[v]};
    if (layer_.layer.role[v] == ActiveLayer::Role::Fixed) continue;
    if (!std::binary_search(moved_.begin(), moved_.end(), place, earlier)) memory.moved.push_back(place);
  }
  memory.moved.insert(memory.moved.end(), moved_.begin(), moved_.end());
  std::sort(memory.moved.begin(), memory.moved.end(), earlier);
  memory.negative = std::move(negative_);
  memory.inside = std::move(inside_);
}

void FastRun::measure_assumptions() {
  // How far a vertex has come stands for its distance to the boundary: it only says which vertex of a face is nearest.
  std::vector<double> distance;
  for (const int i : result_.submesh.positive_vertices) {
    distance.push_back((result_.final[i] - result_.submesh.mesh.V[i]).norm());
  }
  const ConditioningAngles angles = conditioning_angles(result_.submesh, distance);
  result_.conditioning_angle_max_deg = angles.max_deg;
  result_.obtuse_conditioning_angles = angles.not_acute.count;
}

/// Flips vertices where that mends a tet.
void FastRun::repair_classification() {
  if (!costs_ || (params_.flips_follow && !background_.is_lattice())) return;
  RepairParams params = params_.repair;
  params.target += costs_->repair_target - kQualityTarget;
  if (!background_.is_lattice()) params.lift = 0;
  params.reach = std::min(params.reach, costs_->repair_reach);
  params.slides = params.slides && !memory_;
  RepairReport repaired =
      repair(background_, *costs_->links, psi_, classification_params_, params, layer_, inside_, context_, kept_);
  result_.n_psi_evaluations += repaired.psi_evaluations;
  moved_ = std::move(repaired.moved);
}

/// Boundary vertices go to psi = 0, as far as no tet inverts, and the layer is relaxed.
/// @param projected  receives the places between the two
void FastRun::relax(std::vector<Vec3>& projected) {
  if (!kept_.empty()) {
    const IdSet loose = loose_vertices(background_, *costs_->links, inside_, kept_);
    layer_ = linked_active_layer(background_, *costs_->links, inside_, params_.layers, &loose);
    begin_where_kept(kept_, params_.projection, layer_);
  } else {
    // The tets of a stored mesh are as good as whoever made it: the worst may be anywhere. From instant to instant only
    // those at the boundary move, because the others are to stay.
    const bool all_move = background_.is_stored() && !memory_;
    const int layers = all_move ? std::numeric_limits<int>::max() : params_.layers;
    layer_ = costs_ ? linked_active_layer(background_, *costs_->links, inside_, layers)
                    : walled_active_layer(background_, inside_, params_.layers);
  }
  LayerFit fit{.smoothing = params_.smoothing};
  if (memory_ && !memory_->moved.empty()) {
    fit.smoothing.margin = std::min(fit.smoothing.margin, params_.update_margin);
    fit.smoothing.least_gain = std::max(fit.smoothing.least_gain, kUpdateLeastGain);
    fit.smoothing.fine_gain = std::max(fit.smoothing.fine_gain, kUpdateLeastGain);
    const WarmStart start = warm_start(background_, psi_, inside_, *memory_, params_.projection, layer_, context_);
    result_.n_psi_evaluations += start.psi_evaluations;
    memory_->n_recalled = start.n_recalled;
    fit.is_on_surface = start.is_on_surface;
  }
  const std::vector<std::uint8_t> inside = memory_ ? std::vector<std::uint8_t>() : inside_of(layer_, inside_);
  if (!memory_) fit.inside = &inside;
  PNormSmoother smoother(layer_.layer);
  layer_.layer.ring = {};  // the smoother has listed their faces, and omega_h will need the memory
  FittedLayer made = fit_layer(smoother, psi_, params_, fit, context_);
  result_.n_psi_evaluations += made.psi_evaluations;
  projected = std::move(made.projected);
}

void FastRun::fit() {
  context_.report("project", 0);
  std::vector<Vec3> projected;
  relax(projected);
  context_.report("repair", .7);
  repair_classification();
  complete();
  tbb::parallel_invoke([&] { result_.final = coordinates(layer_.layer.V, &KeptVertex::final); },
                       [&] { result_.projected = coordinates(projected, &KeptVertex::projected); });
  const auto h_at = [&](int v) { return background_.h(result_.submesh.background_vertex[v]); };
  result_.n_stepped_back = step_back(result_.submesh, result_.walls, h_at, result_.final, context_).vertices.size();
  measure_assumptions();
  context_.report("repair", 1);
}

}  // namespace

ChosenSubmesh classified_submesh(const BackgroundMesh& background, ImplicitFunctionRef psi,
                                 const SubmeshParams& submesh, const FastParams& params, const Context& context,
                                 const std::vector<Vec3>& seeds) {
  return FastRun(background, psi, submesh, params, context).choose(seeds);
}

ChosenSubmesh classified_submesh(const BackgroundMesh& background, ImplicitFunctionRef psi,
                                 const SubmeshParams& submesh, const FastParams& params, const FormerMesh& former,
                                 const Context& context) {
  return FastRun(background, psi, submesh, params, context).choose(former);
}

UmResult fast_mesh(const BackgroundMesh& background, ImplicitFunctionRef psi, const SubmeshParams& submesh,
                   const FastParams& params, ChosenSubmesh chosen, const Context& context) {
  FastRun run(background, psi, submesh, params, context, std::move(chosen.links));
  return run.fit(std::move(chosen));
}

UmResult fast_mesh(const BackgroundMesh& background, ImplicitFunctionRef psi, const SubmeshParams& submesh,
                   const FastParams& params, const Context& context, IdSet inside, FastMemory& memory,
                   const PsiValues& known) {
  return FastRun(background, psi, submesh, params, context, memory.links)(std::move(inside), memory, known);
}

}  // namespace umtet
