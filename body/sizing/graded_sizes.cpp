#include "body/sizing/graded_sizes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "body/edges/feature_sizes.h"
#include "body/errors.h"
#include "body/option_names.h"
#include "body/pieces/zero_set_choice.h"
#include "body/piecewise_body.h"
#include "body/sizing/edge_length.h"
#include "body/sizing/sheet_support.h"
#include "common/formatted.h"
#include "common/polled_loops.h"
#include "mesh/core/asking_psi.h"
#include "mesh/sizes/graded_size.h"
#include "mesh/sizes/surface_sizes.h"
#include "reconstruct/solve/resolution.h"

namespace umtet {
namespace {

// Sizes fall to this share of h where nothing else says how far: edges that differ by 16 on the boundary.
constexpr double kLeastOfH = 1. / 16;
// Of a body with sharp edges, as shares of the diagonal: the largest size, because flat faces and straight edges ask
// for no small tets, and the largest distance of a flat face from a curved patch.
constexpr double kEdgedMeshEdge = .04, kEdgedDeviation = 5e-4;
// Edges across its thin parts: 1.2 where the body is thickened before its vertices are chosen, and 1.7 where it is not,
// as in graded meshes. With 1.2 the walls of .031 in featuretype.STL break through.
constexpr double kThickenedEdgesAcross = 1.2, kGradedEdgesAcross = 1.7;
// Its sizes fall to this share of the largest.
constexpr double kLeastOfEdgedH = 1. / 64;
// Where a mesh failed they may fall to this share of that floor.
constexpr double kLeastOfFloor = 1. / 4;
// Places along the longer side of the box at which sizes inside are looked at for the least.
constexpr int kInside = 32;
// Of the number of tets with h: between that of a surface and that of a body.
constexpr double kPower = 2.5;
// The estimate of the number of tets is good to 10 %; with the power above it gets there in three rounds.
constexpr double kGoodEnough = .05;
constexpr int kMostRounds = 6;

/// The options by which sizes are given.
std::vector<Option> given_sizes(const BodyOptions& options) {
  const MeshOptions& p = options.mesh;
  std::vector<Option> given;
  const auto note = [&](bool is_given, Option option) {
    if (is_given) given.push_back(option);
  };
  note(static_cast<bool>(options.sizes), option::sizes);
  note(static_cast<bool>(options.label_sizes), option::label_sizes);
  note(p.h_min > 0, option::h_min);
  note(p.h_max > 0, option::h_max);
  note(p.grade_inside, option::grade_inside);
  note(options.max_turn_is_given, option::max_turn);
  note(options.grade_is_given, option::grade);
  return given;
}

bool has_less_h(const SizeSource& a, const SizeSource& b) { return a.h < b.h; }

/// Half the spacing of the lattice on which sizes inside are looked at.
double half_spacing(const Domain& domain) { return domain.box.sizes().maxCoeff() / (2 * kInside); }

/// Its places where psi < 0.
std::vector<Vec3> places_inside(const Domain& domain, const Context& context) {
  const double half = half_spacing(domain);
  const ImplicitFunctionRef psi = domain.psi();
  std::vector<std::uint8_t> is_inside(kInside * kInside * kInside, 0);
  const auto place = [&](std::size_t i) -> Vec3 {
    const auto at = static_cast<int>(i);
    const Eigen::Vector3i step(at % kInside, at / kInside % kInside, at / (kInside * kInside));
    return domain.box.min() + half * (2 * step.cast<double>() + Vec3::Ones());
  };
  for_each_asking(psi, is_inside.size(), kValuesPerPoll, context, [&](std::size_t i) {
    const Vec3 x = place(i);
    is_inside[i] = (x.array() < domain.box.max().array()).all() && psi.value(x) < 0;
  });
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < is_inside.size(); ++i)
    if (is_inside[i]) places.push_back(place(i));
  return places;
}

}  // namespace

bool is_graded(const BodyOptions& options) {
  const std::string& background = options.mesh.background;
  return background == "graded" || (background == "auto" && !given_sizes(options).empty());
}

void require_graded(const BodyOptions& options) {
  const MeshOptions& p = options.mesh;
  if (!is_graded(options)) {
    const std::vector<Option> given = given_sizes(options);
    if (!given.empty()) throw UsageError({given.front(), " is for ", Setting(option::background, "graded")});
    return;
  }
  if (p.h_max > 0 && p.h_min > p.h_max) {
    throw UsageError(
        {Setting(option::h_min, shortest(p.h_min)), " is above ", Setting(option::h_max, shortest(p.h_max))});
  }
  if (p.h > 0 && p.h_min > p.h)
    throw UsageError({Setting(option::h_min, shortest(p.h_min)), " is above ", Setting(option::h, shortest(p.h))});
  if (p.grade_inside && !(p.max_deviation == 0 && !options.sizes && !options.label_sizes)) {
    throw UsageError({option::grade_inside, " keeps ", option::h, " on all of the boundary: without ",
                      option::max_deviation, ", ", option::sizes, " and ", option::label_sizes});
  }
  if (options.label_sizes) options.label_sizes();
}

GradedSizes::GradedSizes(BodyOptions options, const Vec3& shift) : options_(std::move(options)), shift_(shift) {
  if (!options_.sizes) return;
  GivenSizes given = options_.sizes();
  asked_ = std::move(given.sources);
  for (SizeSource& s : asked_) s.x -= shift;
  if (given.function) formula_ = [f = std::move(given.function), shift](const Vec3& x) { return f(x + shift); };
  formula_name_ = std::move(given.name);
}

/// The sizes of a body of triangles with sharp edges, which need no psi.
std::vector<SizeSource> edged_sizes(const Domain& domain, const MeshOptions& p, double edges_across,
                                    const Context& context) {
  double h = p.h > 0 ? p.h : kEdgedMeshEdge * domain.diagonal;
  if (p.h_max > 0) h = std::min(h, p.h_max);
  const FeatureSizeParams params{.h = h,
                                 .h_min = std::min(h, p.h_min > 0 ? p.h_min : kLeastOfEdgedH * h),
                                 .edges_across = edges_across,
                                 .deviation = p.max_deviation > 0 ? p.max_deviation / (kSizeTolerance * kSizeTolerance)
                                                                  : kEdgedDeviation * domain.diagonal};
  const PiecewiseBody& body = *domain.piecewise;
  return feature_sizes(domain.triangles->whole, domain.triangles->edges, *body.graph, body.curvature, params, context);
}

double least_edged_size(const Domain& domain, const MeshOptions& options, const Context& context) {
  const std::vector<SizeSource> sources = edged_sizes(domain, options, kThickenedEdgesAcross, context);
  return std::min_element(sources.begin(), sources.end(), has_less_h)->h;
}

void GradedSizes::add_edges(const Domain& domain, const Context& context) {
  const std::vector<SizeSource> sources =
      edged_sizes(domain, options_.mesh, kGradedEdgesAcross * kSizeTolerance, context);
  sources_.insert(sources_.end(), sources.begin(), sources.end());
  box_.extend(domain.box);
  ++n_domains_;
  const double least = std::min_element(sources.begin(), sources.end(), has_less_h)->h;
  h_min_ = h_min_ > 0 ? std::min(h_min_, least) : least;
  find_finest(domain, context);
}

bool GradedSizes::add(Domain& domain, const Context& context, double most_tets) {
  const MeshOptions& p = options_.mesh;
  if (domain.has_edges_of_triangles()) {
    add_edges(domain, context);
    return true;
  }
  const double largest = p.h_max > 0 ? p.h_max : std::numeric_limits<double>::infinity();
  const double of_noise = noise_edge(domain);
  SurfaceSizeParams s;
  s.h = p.h > 0 ? p.h : std::max(of_noise, (p.max_deviation > 0 ? kMostOfDiagonal : kMeshEdge) * domain.diagonal);
  s.h = std::min(s.h, largest);
  s.h_min = p.h_min > 0 ? p.h_min : std::max(kLeastOfH * s.h, of_noise);
  s.h_min = std::min(s.h_min, s.h);
  s.grade = p.grade;
  s.constant_layer = p.constant_layer;
  s.steepest = domain.steepest();
  // Edges may be kSizeTolerance as long as the size: what may not be exceeded asks for as much less.
  s.edges_across *= kSizeTolerance;
  s.max_turn = p.max_turn * std::numbers::pi / 180 / kSizeTolerance;
  if (options_.max_turn_is_given) {
    s.least_by_turn = s.h_min / s.h;
  } else {
    s.noise = domain.noise.value_or(0);
  }
  s.deviation = p.max_deviation / (kSizeTolerance * kSizeTolerance);
  if (p.grade_inside) s.edges_across = s.max_turn = 0;
  std::optional<SheetSupport> support;
  if (domain.level_set && !domain.cloud.points.empty() && domain.cloud.normals.size() == domain.cloud.points.size()) {
    s.is_known = std::cref(support.emplace(domain));
  }
  domain.limit_detail(s.h_min);
  const ZeroSetChoice pieces = choose_components(domain, std::min(s.h, kMeshEdge * domain.diagonal), context);
  const std::vector<Vec3> points = kept_points(pieces);
  if (points.empty()) {
    throw MeshingImpossible(
        "no edge length can be chosen: psi = 0 is nowhere in the box",
        {{Change::Give, option::box, "around the place where psi < 0"}, {Change::Lower, option::h}});
  }
  bool too_many = false;
  const auto make_too_many = [&](const std::vector<SizeSource>& sources) {
    if (!std::isfinite(most_tets)) return false;
    const double h = std::min_element(sources.begin(), sources.end(), has_less_h)->h;
    const SizeField sizes(sources, {.grade = s.grade, .h_min = s.h_min}, {}, context);
    return too_many = expected_graded_tets(sizes, h, domain.psi(), domain.box, domain.steepest(), context) > most_tets;
  };
  const std::vector<SizeSource> on_surface =
      surface_sizes(domain.psi(), points, std::max(pieces.topology.spacing, s.h), s, context, make_too_many);
  if (too_many) return false;
  sources_.insert(sources_.end(), on_surface.begin(), on_surface.end());
  const LabelSizes of_label = options_.label_sizes ? options_.label_sizes() : LabelSizes();
  if (!of_label.factors.empty() && domain.cloud.labels.empty()) {
    throw UsageError({Setting(option::label_sizes, of_label.name), ": the points have no labels"});
  }
  for (std::size_t i = 0; i < domain.cloud.labels.size(); ++i) {
    const auto at = of_label.factors.find(domain.cloud.labels[i]);
    if (at == of_label.factors.end()) continue;
    const double h = std::max(s.h_min, at->second * s.h);
    sources_.push_back({domain.cloud.points[i], h, std::max(p.constant_layer * h, 2 * domain.cloud_spacing)});
  }
  box_.extend(domain.box);
  ++n_domains_;
  h_min_ = h_min_ > 0 ? std::min(h_min_, s.h_min) : s.h_min;
  find_finest(domain, context);
  return true;
}

/// A formula that is no length in the body asks for tets without end, unless mesh.h_min says how far it is raised.
void GradedSizes::require_lengths(const std::vector<Vec3>& inside) const {
  if (!formula_ || options_.mesh.h_min > 0) return;
  std::optional<Vec3> worst;
  double least = 0;
  const auto look = [&](const Vec3& x) {
    const double h = formula_(x);
    if (h > 0 || (worst && !(h < least))) return;
    worst = x;
    least = h;
  };
  for (const SizeSource& s : sources_) look(s.x);
  for (const Vec3& x : inside) look(x);
  if (!worst) return;
  const Vec3 at = *worst + shift_;
  throw UsageError({Setting(option::sizes, formula_name_),
                    formatted(" is %.4g at (%.4g, %.4g, %.4g), which is in the body: edge lengths are above 0", least,
                              at.x(), at.y(), at.z())},
                   {{Change::Use, option::h_min, "raises what is less"}});
}

/// With what the user asks for: at the sources, and on a lattice inside.
void GradedSizes::find_finest(const Domain& domain, const Context& context) {
  finest_ = std::min_element(sources_.begin(), sources_.end(), has_less_h)->h;
  if (asked_.empty() && !formula_) return;
  const std::vector<Vec3> inside = places_inside(domain, context);
  require_lengths(inside);
  const SizeField sizes = field(finest_, context);
  std::vector<double> least(sources_.size() + inside.size());
  const double half = half_spacing(domain);
  polled_parallel_for(least.size(), kValuesPerPoll, context, [&](std::size_t i) {
    const std::size_t n = sources_.size();
    least[i] = i < n ? sizes.at(sources_[i].x) : sizes.least_in(inside[i - n], half);
  });
  finest_ = std::min(finest_, *std::min_element(least.begin(), least.end()));
}

std::optional<double> GradedSizes::refine(const std::vector<SizeSource>& wanted, double h) {
  const double factor = h / finest_, given = options_.mesh.h_min;
  const double floor = given > 0 ? given : kLeastOfFloor * h_min_;
  const std::size_t n = finer_.size();
  double least = finest_;
  for (SizeSource s : wanted) {
    s.h /= factor, s.radius /= factor;
    if (s.h < floor) continue;
    finer_.push_back(s);
    least = std::min(least, s.h);
  }
  if (finer_.size() == n) return std::nullopt;
  // In halves, so that the cubes elsewhere stay what they were.
  while (finest_ > kSizeTolerance * least) finest_ /= 2;
  return factor * finest_;
}

SizeField GradedSizes::field(double h, const Context& context) const {
  const double factor = h / finest_, h_max = options_.mesh.h_max;
  std::vector<SizeSource> all = asked_;
  all.insert(all.end(), sources_.begin(), sources_.end());
  for (SizeSource& s : all) s.h *= factor, s.radius *= factor;
  SizeFieldParams params{.grade = options_.mesh.grade, .h_min = factor * h_min_};
  // The floor is for what thickness and curvature ask for; who asks for less by a file or a formula means it.
  if (options_.mesh.h_min == 0) {
    for (const SizeSource& s : asked_) params.h_min = std::min(params.h_min, factor * s.h);
    if (formula_) params.h_min *= kLeastOfH;
  }
  if (h_max > 0) params.h_max = std::max(params.h_min, factor * h_max);
  std::optional<SizeFunction> f;
  if (formula_) f = SizeFunction{[formula = formula_, factor](const Vec3& x) { return factor * formula(x); }, box_};
  SizeField sizes(std::move(all), params, std::move(f), context);
  if (finer_.empty()) return sizes;
  std::vector<SizeSource> finer = finer_;
  for (SizeSource& s : finer) s.h *= factor, s.radius *= factor;
  return sizes.refined(std::move(finer));
}

double h_ratio_of_tets(double n) { return std::pow(n, 1 / kPower); }

double h_of_graded_tets(const GradedSizes& sizes, const Domain& domain, double n_tets, const Context& context) {
  double h = sizes.finest();
  for (int round = 0; round < kMostRounds; ++round) {
    const double n =
        expected_graded_tets(sizes.field(h, context), h, domain.psi(), domain.box, domain.steepest(), context);
    if (!(n > 0)) {
      throw MeshingImpossible(
          "no edge length can be chosen: psi is not negative at any of the places looked at in the box",
          {{Change::Give, option::h}, {Change::Give, option::box, "around the place where psi < 0"}});
    }
    const double ratio = n / n_tets;
    if (std::abs(ratio - 1) < kGoodEnough) break;
    h *= h_ratio_of_tets(ratio);
  }
  return h;
}

}  // namespace umtet
