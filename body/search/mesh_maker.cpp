#include "body/search/mesh_maker.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "body/errors.h"
#include "body/fidelity/measure.h"
#include "body/fidelity/verdict.h"
#include "body/fidelity/volume_match.h"
#include "body/pieces/component_proof.h"
#include "body/search/piecewise_fit.h"
#include "body/search/rounded_mesh.h"
#include "body/search/second_order.h"
#include "body/sizing/edge_length.h"
#include "body/sizing/too_thin.h"
#include "common/formatted.h"
#include "mesh/fast/flips/flipped_submesh.h"

namespace umtet {
namespace {

// Noise and outliers leave hundreds.
constexpr std::size_t kSaidPieces = 5;

// Another h is tried for the number of tets that was asked for when it is missed by more than this.
constexpr double kTetsTolerance = .1;
// This often; then the h that missed it least is taken.
constexpr int kMostMisses = 4;
// Pieces of psi = 0 are looked for on a grid of h and, where there is none, on this many more grids, each of half the
// spacing.
constexpr int kFinerGrids = 3;
// Of a graded mesh they are counted at this share of its sizes: edges are then no longer than sqrt(3) of the size, as
// on a grid, and those of another octree than its own.
constexpr double kShareOfSizes = .8;
// Where each part of an attempt begins, as a share of its time.
constexpr double kPieces = .05, kChoice = .1, kFit = .2, kFlips = .6, kCertificate = .9, kCurving = .95;

/// Whether a search for this h would find the same cells.
bool are_cells_for(double h, const SignCells& cells) { return cells.size <= h / 2 && h / 2 < 2 * cells.size; }

/// A point of each piece, where not all are meshed.
std::vector<Vec3> seeds_of_some(const ZeroSetChoice& pieces) {
  return pieces.dropped.empty() ? std::vector<Vec3>() : pieces.seeds;
}

}  // namespace

MeshMaker::MeshMaker(Domain& domain, BodyOptions options, Context context, MeshLines lines, PartMaker* ranks)
    : domain_(domain),
      options_(std::move(options)),
      context_(std::move(context)),
      lines_(std::move(lines)),
      params_(um_params(options_.mesh)),
      ranks_(ranks) {
  if (domain_.piecewise) require_piecewise(options_);
}

const ZeroSetChoice& MeshMaker::pieces_at(double h, const SizeField* sizes) {
  domain_.limit_detail(h);
  // A grid and a graded mesh of the same h count on other edges.
  const bool is_counted = pieces_ && pieces_->first == h && (pieces_->second.share > 0) == (sizes != nullptr);
  if (!is_counted) {
    context_.report("components", kPieces);
    const int n_levels = domain_.level_set ? domain_.level_set->n_levels() : 0;
    std::optional<SignCells> known;
    if (pieces_ && n_levels == n_levels_) known = std::move(pieces_->second.cells);
    n_levels_ = n_levels;
    // A body thinner than the grid may have no node inside.
    for (int halvings = 0; halvings <= kFinerGrids; ++halvings) {
      const double finer = std::ldexp(1., -halvings);
      const bool is_known = known && (sizes || are_cells_for(finer * h, *known));
      const SignCells* cells = is_known ? &*known : nullptr;
      pieces_.emplace(h, sizes ? choose_components(domain_, *sizes, h, finer * kShareOfSizes, context_, cells)
                               : choose_components(domain_, finer * h, context_, cells));
      if (is_known) pieces_->second.cells = std::exchange(known, std::nullopt);
      if (!pieces_->second.topology.components.empty()) break;
    }
  }
  return pieces_->second;
}

// Share of the surface that is thinner than two layers of tets: then flat tets are the rule, and what repair may reach
// of them is the aim.
constexpr double kMostlyThin = .3;
// Flips raise the tets of a thin body with sharp edges by so much in a third of the time that the last tets take.
constexpr double kFlipsGain = .05;

UmParams MeshMaker::params_for(const ZeroSetChoice& pieces, double h) const {
  UmParams params = params_;
  if (is_thickened_) {
    const double thickness = thickness_->second.share(kMostlyThin);
    const double aim = quality_within_reach(thickness, h);
    if (aim < params.fast.quality_target()) params.fast.set_quality_target(aim);
  }
  if (domain_.piecewise) params.fast.classification = piecewise_params(options_.mesh).classification;
  // The full loop would mesh every piece; crawling starts from the ones to keep.
  if (!pieces.dropped.empty()) params.submesh.search = SubmeshSearch::Crawl;
  return params;
}

/// From cell to cell of a lattice, psi has the sign that it had where there can be no zero between.
KnownSigns MeshMaker::known_signs(const BackgroundMesh& background, const ZeroSetChoice& pieces) const {
  if (!pieces.cells || !background.is_lattice()) return {};
  const auto& n = background.n_cells();
  const double reach = (background.box().sizes().array() / Eigen::Array3d(n[0], n[1], n[2])).maxCoeff();
  const auto map =
      std::make_shared<const ZeroFreeMap>(*pieces.cells, domain_.box.intersection(domain_.level_set->domain()), reach);
  return {[map](const Vec3& x) { return (*map)(x); }, reach};
}

/// None where the body is as thick as the tets need it, or may not be thickened.
const TriangleThickness* MeshMaker::thin_triangles(const BackgroundMesh& background, const ZeroSetChoice& pieces,
                                                   double h) {
  if (!may_be_thickened(domain_, options_) || ranks_ || !background.is_lattice() || !pieces.dropped.empty())
    return nullptr;
  if (!thickness_ || thickness_->first < h) thickness_ = {h, triangle_thickness(domain_, kEdgesAcross * h, context_)};
  return thickness_->second.share(0) < kEdgesAcross * h ? &thickness_->second : nullptr;
}

/// psi cut for h, and what h is too large for.
MeshAttempt MeshMaker::begin(const SizedBackground& background, double h) {
  MeshAttempt a;
  a.h = h;
  a.sizes = background.sizes;
  if (a.sizes) a.background = background.mesh;
  domain_.level_shift = 0;
  const ZeroSetChoice& pieces = pieces_at(h, a.sizes.get());
  a.n_levels = n_levels_;
  a.n_pieces = pieces.seeds.size();
  a.n_dropped = pieces.dropped.size();
  a.thin = find_thin_places(domain_, pieces, h, context_);
  if (!a.thin.empty() && lines_.detail) {
    lines_.detail(formatted("%zu places are thinner than h = %.4g can show for certain:\n%s", a.thin.places.size(), h,
                            described(a.thin, domain_.shift).c_str()));
  }
  const std::size_t n = pieces.dropped.size(), n_said = std::min(n, kSaidPieces);
  for (std::size_t k = 0; k < n_said; ++k) say("left out a " + pieces.dropped[k]);
  if (n > n_said) say(formatted("left out %zu more pieces, which the certificate lists", n - n_said));
  return a;
}

/// Of the same psi, and the same pieces of it.
bool MeshMaker::may_keep(const MeshAttempt& former, const ZeroSetChoice& pieces) const {
  return params_.mode == UmMode::Fast && !domain_.piecewise && former.made() && former.background &&
         former.n_levels == n_levels_ && former.n_pieces == pieces.seeds.size() &&
         former.n_dropped == pieces.dropped.size();
}

ChosenSubmesh MeshMaker::choose(const BackgroundMesh& background, const ZeroSetChoice& pieces,
                                const MeshAttempt* former) {
  if (lines_.detail) {
    lines_.detail(formatted("h = %.6g, background of %lld tets, psi = 0 in %zu pieces", background.h(),
                            static_cast<long long>(background.n_tets()), pieces.topology.components.size()));
  }
  const TriangleThickness* thin = thin_triangles(background, pieces, background.h());
  is_thickened_ = thin != nullptr;
  UmParams params = params_for(pieces, background.h());
  if (thin) {
    const ThickBody body(domain_, *thin, background.h());
    return choose_submesh(background, body, params, context_.part(kChoice, kFit));
  }
  if (former && may_keep(*former, pieces)) {
    return choose_submesh(
        background, domain_.psi(), params,
        {*former->background, former->result.of_background ? *former->result.of_background : former->result,
         seeds_of_some(pieces)},
        context_.part(kChoice, kFit));
  }
  params.submesh.known = known_signs(background, pieces);
  return choose_submesh(background, domain_.psi(), params, context_.part(kChoice, kFit), pieces.seeds);
}

/// None where one process has to.
std::optional<MadeInParts> MeshMaker::made_by_ranks(const SizedBackground& background, const ZeroSetChoice& pieces,
                                                    double h) {
  if (!background.mesh.is_lattice() || domain_.piecewise) {
    if (ranks_->n() > 1 && !has_said_alone_) {
      say(domain_.piecewise ? "one process makes this mesh: its body has sharp edges"
                            : "one process makes this mesh: its background is no lattice");
    }
    has_said_alone_ = true;
    return std::nullopt;
  }
  context_.report("project", kChoice);
  return ranks_->make(background.mesh, background.box, domain_, params_.fast, seeds_of_some(pieces),
                      {h, domain_.shift, coordinate_rounding(domain_)});
}

MeshMaker::Begun MeshMaker::choose(const SizedBackground& background, double h, const MeshAttempt* former) {
  Begun begun{begin(background, h), {}};
  const ZeroSetChoice& pieces = pieces_at(h, begun.attempt.sizes.get());
  if (pieces.seeds.empty() && !pieces.dropped.empty()) {
    throw MeshingImpossible("psi = 0 is nowhere near the samples:\n  no " + pieces.dropped.front());
  }
  if (ranks_) begun.made = made_by_ranks(background, pieces, h);
  if (!begun.made) begun.chosen = choose(background.mesh, pieces, former);
  return begun;
}

void MeshMaker::fit_edges(const SizedBackground& background, ChosenSubmesh chosen, MeshAttempt& a) {
  const double within_reach =
      is_thickened_ ? kFlipsGain + quality_within_reach(thickness_->second.share(kMostlyThin), a.h) : 1;
  PiecewiseFit made = fit_piecewise(*domain_.piecewise, background.mesh, std::move(chosen), options_.mesh, within_reach,
                                    context_.part(kFit, kCertificate));
  a.result = std::move(made.result);
  round_to_file(a.result, domain_.shift);
  if (!a.made()) return;
  made.features->mesh.V = a.result.final;
  a.features = std::move(made.features);
  if (!lines_.detail) return;
  const PiecewiseMesh& f = *a.features;
  lines_.detail(formatted("edges: %zu curves, %zu corners, %zu defects; flips: %zu edges removed, %zu collapsed",
                          f.graph.curves.size(), f.graph.corners.size(), f.defects.size(), f.flips.n_removed_edges,
                          f.flips.n_collapsed));
}

void MeshMaker::fit(const SizedBackground& background, ChosenSubmesh chosen, MeshAttempt& a) {
  if (domain_.piecewise) return fit_edges(background, std::move(chosen), a);
  const ZeroSetChoice& pieces = pieces_at(a.h, a.sizes.get());
  a.result = fit_submesh(background.mesh, domain_.psi(), params_for(pieces, a.h), std::move(chosen),
                         context_.part(kFit, kCertificate));
  if (a.made() && !background.mesh.is_lattice() && params_.fast.flips_follow) flip(a);
  if (a.made()) match_volume(domain_, a.h, params_.fast.projection.closest_point, a.result, context_);
  round_to_file(a.result, domain_.shift);
}

void MeshMaker::flip(MeshAttempt& a) const {
  LocalFlipParams params;
  const double target = options_.mesh.target_quality;
  if (target != MeshOptions().target_quality) params.target = target;  // it has been given
  const LocalFlipReport r = flip_submesh(domain_.psi(), a.h, params, a.result, context_.part(kFlips, kCertificate));
  if (!lines_.detail) return;
  lines_.detail(
      formatted("flips: %zu edges removed, %zu collapsed, %zu patches smoothed in %zu tries; %zu tets are below "
                "%.3g",
                r.n_removed_edges, r.n_collapsed, r.n_smoothed, r.tries, r.n_below, params.target));
}

MeshAttempt MeshMaker::finish(const SizedBackground& background, Begun begun) {
  ++n_attempts_;
  MeshAttempt a = std::move(begun.attempt);
  const ZeroSetChoice& pieces = pieces_at(a.h, a.sizes.get());
  if (begun.made) {
    a.result = std::move(begun.made->result);
    a.parts = std::move(begun.made->mesh);
  } else {
    fit(background, std::move(begun.chosen), a);
  }
  const std::size_t n_flips = a.result.manifold_flips.size(), n_back = a.result.n_stepped_back;
  if (n_flips + n_back > 0 && lines_.detail) {
    lines_.detail(
        formatted("%zu vertices changed sides, so that the boundary is a manifold; %zu went back from psi = "
                  "0, so that it does not meet itself",
                  n_flips, n_back));
  }
  context_.report("certify", kCertificate);
  if (!a.made()) return a;
  const MeshEdge h = mesh_edge(background.mesh, a.result, a.h);
  TetMesh mesh{std::move(a.result.final), std::move(a.result.submesh.mesh.C)};  // lent: there is no copy of all tets
  const MeshCertificate* of_parts = begun.made ? &begun.made->certificate : nullptr;
  Measurement made =
      measure(domain_, mesh, a.result, pieces, h,
              {&a.thin, options_.mesh.max_deviation, a.sizes.get(), of_parts, a.features.get()}, context_);
  a.result.final = std::move(mesh.V);
  a.result.submesh.mesh.C = std::move(mesh.C);
  a.measured = std::move(made.measures);
  a.measured.domain.level_shift = domain_.level_shift;
  a.defects = std::move(made.defects);
  curve(a);
  // Not as output.* asks for: how a mesh is judged does not decide how it is made.
  a.reasons = judge_shape(a.measured).reasons;
  return a;
}

MeshAttempt MeshMaker::attempt(const SizedBackground& background, double h) {
  return finish(background, choose(background, h, nullptr));
}

void MeshMaker::curve(MeshAttempt& a) const {
  const std::int64_t order = options_.mesh.order;
  a.measured.order = order;
  if (order < 2) return;
  context_.report("second order", kCurving);
  if (a.parts) {
    CurvedInParts curved = a.parts->curve(domain_, params_.paper.closest_point);
    a.measured.second_order = curved.report;
    a.mid_sides = std::move(curved.mid_sides);
  } else {
    a.second = curved_mesh(domain_, a.result, a.h, params_.paper.closest_point, context_);
    a.measured.second_order = measure_second_order(domain_, a.result, *a.second, a.h, context_);
  }
  for (std::string& reason : failures(*a.measured.second_order)) a.measured.reasons.push_back(std::move(reason));
}

/// The estimate behind mesh.tets knows the shape from a few thousand samples. Where it is far off, the number of tets
/// at one h gives the next, before anything is moved. Few tets jump with h, to either side of the number asked for.
MeshAttempt MeshMaker::attempt_for_tets(double h, const MakeBackground& make, const MeshAttempt* former) {
  const auto asked = static_cast<double>(options_.mesh.tets);
  if (asked == 0) {
    const SizedBackground made = make(h);
    return finish(made, choose(made, h, former));
  }
  double nearest = h, least_miss = std::numeric_limits<double>::infinity();
  std::optional<double> makes_more, makes_less;
  for (int n_misses = 0;;) {
    const SizedBackground made = make(h);
    Begun begun = choose(made, h, nullptr);
    const double ratio = static_cast<double>(begun.n_tets()) / asked;
    if (!begun.is_possible() || n_misses == kMostMisses || std::abs(ratio - 1) <= kTetsTolerance)
      return finish(made, std::move(begun));
    if (const double miss = std::abs(std::log(ratio)); miss < least_miss) nearest = h, least_miss = miss;
    (ratio > 1 ? makes_more : makes_less) = h;
    const double better = ++n_misses == kMostMisses  ? nearest
                          : makes_more && makes_less ? std::sqrt(*makes_more * *makes_less)
                                                     : h * std::cbrt(ratio);
    say(formatted("h = %.4g makes %.2g times the tets asked for; trying %.4g", h, ratio, better));
    h = std::max(better, least_h_in_file(domain_));
  }
}

MeshAttempt MeshMaker::graded(BackgroundChoice& backgrounds, double h, const MakeBackground& make) {
  return refined_attempt(
      h, options_.mesh.effort,
      [&](double h_of, const MeshAttempt* former) { return attempt_for_tets(h_of, make, former); },
      [&](const MeshAttempt& a) -> std::optional<double> {
        const std::optional<double> finer =
            backgrounds.refine(finer_where_it_failed(a, domain_.shift, options_.mesh.effort), a.h);
        const auto most = static_cast<double>(options_.mesh.max_tets);
        return finer && backgrounds.expected_tets(domain_, *finer) <= most ? finer : std::nullopt;
      },
      [this](const std::string& line) { say(line); });
}

MeshAttempt MeshMaker::best(BackgroundChoice& backgrounds, const EdgeLength& choice, const MakeBackground& make) {
  const MeshOptions& p = options_.mesh;
  MeshAttempt best;
  if (backgrounds.is_graded()) {
    best = graded(backgrounds, choice.h, make);
  } else {
    AttemptsWithOneH attempts(choice, p.effort, [this](const std::string& line) { say(line); });
    while (const std::optional<double> h = attempts.next_h()) attempts.add(attempt_for_tets(*h, make));
    best = or_graded(attempts.take_best(), backgrounds, choice.h, make);
  }
  best.measured.search = {n_attempts_, p.h > 0 || p.tets > 0, choice.at_max_tets};
  return best;
}

/// The best attempt with one h, or one with sizes that vary, if that is better.
MeshAttempt MeshMaker::or_graded(MeshAttempt of_one_h, BackgroundChoice& backgrounds, double first_h,
                                 const MakeBackground& make) {
  const double effort = options_.mesh.effort;
  const bool may_be_remade = !domain_.piecewise && (n_attempts_ == 1 || effort > kDefaultEffort);
  if (of_one_h.is_right() || !may_be_remade || !may_improve(of_one_h, effort)) return of_one_h;
  const double allowed = (effort - n_attempts_) * backgrounds.expected_tets(domain_, first_h);
  try {
    const std::optional<EdgeLength> sizes = backgrounds.grade(domain_, context_);
    if (sizes && backgrounds.expected_tets(domain_, sizes->h) <= allowed) {
      say(formatted("no one h does (%s); trying edges that follow the body", of_one_h.complaint().c_str()));
      MeshAttempt of_sizes = graded(backgrounds, sizes->h, make);
      if (of_sizes.is_right() || (of_sizes.made() && !of_one_h.made())) return of_sizes;
      say(formatted("they will not do either (%s); keeping h = %.4g", of_sizes.complaint().c_str(), of_one_h.h));
    }
  } catch (const MeshingImpossible& e) {
    say("edges that follow the body are not possible: " + e.message);
  } catch (const ResourceLimit& e) {
    say("edges that follow the body are not possible: " + e.message);
  }
  backgrounds.drop_grading();
  return of_one_h;
}

std::string too_thin_text(const MeshAttempt& a, const Vec3& shift) {
  const std::size_t n = a.thin.places.size();
  return formatted("h = %.4g is too large: %s; %zu place%s thinner than it can show\n%s", a.h, a.complaint().c_str(), n,
                   n == 1 ? " is" : "s are", described(a.thin, shift).c_str());
}

}  // namespace umtet
