#include "body/sizing/background_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "body/errors.h"
#include "body/option_names.h"
#include "body/sizing/mesh_memory.h"
#include "body/sizing/thick_body.h"
#include "common/formatted.h"
#include "mesh/background/a15_box.h"
#include "mesh/base/id_set.h"
#include "mesh/core/asking_psi.h"
#include "mesh/octree/graded_mesh.h"
#include "mesh/sizes/graded_size.h"
#include "reconstruct/solve/resolution.h"

namespace umtet {
namespace {

// Graded tets are of lower quality, so they have to be fewer by this factor.
constexpr double kWorthIt = 2;
// Where sizes follow the features of a body with sharp edges, flips make graded tets as good: it is enough if they are
// this much fewer.
constexpr double kWorthItAtEdges = 1.25;
// A body is thin nearly everywhere if this share of its surface is.
constexpr double kMostOfThinBody = .8;
constexpr double kTetsOfThinBody = 120'000;
// Edges across the thickness of such a body, at least: with .55 a box with walls of .5 in 100 lacks half of its edges.
constexpr double kThinnest = .8;
// It is no longer worth the tets if they are far more than kTetsOfThinBody: the square of this, because they are as
// many as its area has faces.
constexpr double kFarMore = 1.4;

}  // namespace

const Tiling& tiling_of(const MeshOptions& options) {
  return options.background == "auto" ? a15() : tiling_named(options.background);
}

bool has_own_background(const BodyOptions& options) {
  const std::string& name = options.mesh.background;
  const auto names = tiling_names();
  return name != "auto" && name != "graded" && std::find(names.begin(), names.end(), name) == names.end();
}

void require_walls(const BodyOptions& options) {
  const bool walls = options.mesh.box_walls;
  const std::string& name = options.mesh.background;
  const bool is_a15 = name == "a15" || (name == "auto" && !is_graded(options));
  if (walls && !is_a15) {
    throw UsageError({option::box_walls, " is for ", Setting(option::background, "a15")});
  }
  if (walls || !options.mesh.complement) return;
  throw UsageError({option::complement, " needs ", option::box_walls,
                    ": what is around the body ends at the flat walls of ", option::box});
}

ClassificationSource classification_source(const BodyOptions& options) {
  const bool is_tiling = !is_graded(options) && !has_own_background(options);
  const bool chosen = options.mesh.mode == UmMode::Fast && !options.mesh.box_walls && is_tiling;
  return chosen ? ClassificationSource::Chosen : ClassificationSource::Psi;
}

BackgroundChoice::BackgroundChoice(BodyOptions options, const Domain& domain)
    : options_(std::move(options)),
      is_ours_(options_.mesh.background == "auto" && !umtet::is_graded(options_)),
      tiling_(&a15()),
      source_(classification_source(options_)),
      walls_(options_.mesh.box_walls) {
  require_walls(options_);
  require_graded(options_);
  if (umtet::is_graded(options_)) {
    graded_.emplace(options_, domain.shift);
    return;
  }
  const bool is_given = has_own_background(options_);
  if (!is_given) tiling_ = &tiling_of(options_.mesh);
  if (!is_given) return;
  if (options_.mesh.h > 0 || options_.mesh.tets > 0) {
    throw UsageError({option::h, " and ", option::tets, ": " + options_.mesh.background + " has its own edge lengths"});
  }
  if (!options_.background) throw UsageError({Setting(option::background, options_.mesh.background), ": unknown"});
  given_.emplace(options_.background(domain.shift));
}

bool BackgroundChoice::may_be_graded(const Domain& domain) const {
  const MeshOptions& p = options_.mesh;
  if (domain.has_edges_of_triangles()) return is_ours_ && !walls_ && p.h == 0;
  return is_ours_ && (domain.level_set || domain.labels) && p.mode == UmMode::Fast && !walls_ && p.h == 0 &&
         p.max_deviation == 0;
}

/// @param one  the choice of one h
void BackgroundChoice::grade_if_worth_it(Domain& domain, const EdgeLength& one, const Context& context) {
  const double least = std::cbrt(1 / kWorthIt) * kMeshEdge * domain.diagonal;  // sizes are no larger than h by default
  // To find sizes takes as long as a small mesh. Graded faces are smaller than in proportion, by a quarter and more.
  constexpr double kFewFaces = 1. / 3;
  if (one.needed > least || one.graded_faces > kFewFaces) return;
  const double uniform = umtet::expected_tets(*tiling_, domain.size(), one.needed, source_);
  GradedSizes sizes(options_, domain.shift);
  if (!sizes.add(domain, context, uniform / kWorthIt)) return;
  const double h = sizes.finest();
  Known graded{h, std::make_shared<const SizeField>(sizes.field(h, context)), {}};
  graded.n_tets = expected_graded_tets(*graded.sizes, h, domain.psi(), domain.box, domain.steepest(), context);
  if (uniform <= kWorthIt * *graded.n_tets) return;
  graded_.emplace(std::move(sizes));
  known_ = std::move(graded);
  uniform_tets_ = uniform;
}

/// The least size on the features. A body that is thin nearly everywhere has larger edges, up to 1 / kThinnest of its
/// thickness, where it would have more than kTetsOfThinBody tets. \throw MeshingImpossible  it has far more even so
double BackgroundChoice::one_h_by_edges(const Domain& domain, const Context& context) const {
  const double h = least_edged_size(domain, options_.mesh, context);
  const double h_of_few = h_for_tets(*tiling_, domain.size(), kTetsOfThinBody, source_);
  if (!(h_of_few > h)) return h;
  const double thickness = triangle_thickness(domain, 2 * kEdgesAcross * h, context).share(kMostOfThinBody);
  if (!(thickness < kEdgesAcross * h)) return h;
  const double largest = thickness / kThinnest;
  if (h_of_few > kFarMore * largest) {
    throw MeshingImpossible(
        formatted("the body is thin nearly everywhere: with its sharp edges it needs h = %.3g, about %.2g tets",
                  largest, umtet::expected_tets(*tiling_, domain.size(), largest, source_)),
        {{Change::Give, option::h}});
  }
  return std::min(h_of_few, largest);
}

/// The least size on the features of a body of triangles with sharp edges, as one h or, if that takes a quarter more
/// tets, the least of varying sizes.
EdgeLength BackgroundChoice::edge_length_by_edges(Domain& domain, const Context& context) {
  GradedSizes sizes(options_, domain.shift);
  sizes.add(domain, context);
  const double h = sizes.finest();
  Known graded{h, std::make_shared<const SizeField>(sizes.field(h, context)), {}};
  graded.n_tets = expected_graded_tets(*graded.sizes, h, domain.psi(), domain.box, domain.steepest(), context);
  const double one = one_h_by_edges(domain, context);
  const double uniform = umtet::expected_tets(*tiling_, domain.size(), one, source_);
  is_decided_ = true;
  if (uniform <= kWorthItAtEdges * *graded.n_tets && uniform <= static_cast<double>(options_.mesh.max_tets))
    return options_.mesh.tets > 0 ? choose_edge_length(domain, options_, context) : representable({one, one}, domain);
  graded_.emplace(std::move(sizes));
  known_ = std::move(graded);
  uniform_tets_ = uniform;
  return graded_edge_length(domain, context);
}

EdgeLength BackgroundChoice::edge_length(Domain& domain, const Context& context) {
  if (given_) return {given_->h(), given_->h()};
  if (!graded_ && !is_decided_ && domain.has_edges_of_triangles() && may_be_graded(domain))
    return edge_length_by_edges(domain, context);
  if (!graded_) {
    const EdgeLength uniform = choose_edge_length(domain, options_, context);
    if (!is_decided_ && may_be_graded(domain)) grade_if_worth_it(domain, uniform, context);
    is_decided_ = true;
    return graded_ ? graded_edge_length(domain, context) : uniform;
  }
  graded_->add(domain, context);
  known_.reset();
  return graded_edge_length(domain, context);
}

std::optional<EdgeLength> BackgroundChoice::grade(Domain& domain, const Context& context) {
  if (graded_ || !may_be_graded(domain)) return std::nullopt;
  GradedSizes sizes(options_, domain.shift);
  sizes.add(domain, context);
  graded_.emplace(std::move(sizes));
  known_.reset();
  return graded_edge_length(domain, context);
}

EdgeLength BackgroundChoice::graded_edge_length(const Domain& domain, const Context& context) const {
  const MeshOptions& p = options_.mesh;
  if (p.tets > 0) {
    const double h = h_of_graded_tets(*graded_, domain, static_cast<double>(p.tets), context);
    return representable({h, h}, domain);
  }
  const double h = graded_->finest(), n = expected_tets(domain, h);
  if (n <= static_cast<double>(p.max_tets)) {
    return representable({h, p.h > 0 ? h : h * h_ratio_of_tets(n / static_cast<double>(p.max_tets))}, domain);
  }
  const double least = h_of_graded_tets(*graded_, domain, static_cast<double>(p.max_tets), context);
  if (p.h > 0 || p.max_deviation > 0 || options_.sizes || options_.label_sizes) {
    throw ResourceLimit(
        formatted(
            "these sizes, %.4g where they are least, make about %.2g tets, more than %lld (that many at sizes that "
            "are %.2g times as large)",
            h, n, static_cast<long long>(p.max_tets), least / h),
        {{Change::Raise, option::max_tets}});
  }
  return representable({.h = least, .least = least, .at_max_tets = true}, domain);
}

std::optional<double> BackgroundChoice::refine(const std::vector<SizeSource>& wanted, double h) {
  known_.reset();
  return graded_->refine(wanted, h);
}

const std::shared_ptr<const SizeField>& BackgroundChoice::sizes_for(double h) const {
  if (!known_ || known_->h != h) known_ = {h, std::make_shared<const SizeField>(graded_->field(h)), {}};
  return known_->sizes;
}

double BackgroundChoice::expected_tets(const Domain& domain, double h) const {
  if (!graded_) return umtet::expected_tets(*tiling_, domain.size(), h, source_);
  const SizeField& sizes = *sizes_for(h);
  if (known_->n_tets) return *known_->n_tets;
  const double n = expected_graded_tets(sizes, h, domain.psi(), domain.box, domain.steepest());
  if (graded_->n_domains() == 1) known_->n_tets = n;  // the sizes of several are asked for each of them
  return n;
}

double BackgroundChoice::least_h(const Domain& domain) const {
  if (!graded_) return least_h_of_max_tets(domain, options_);
  const double h = graded_->finest();
  return h * h_ratio_of_tets(expected_tets(domain, h) / static_cast<double>(options_.mesh.max_tets));
}

/// Of cubes that meet the box. Where one body alone has been asked for: first without those that the slope of psi shows
/// to be far from it, then with those alone that are some edges from a vertex in it.
BackgroundMesh BackgroundChoice::graded(const Domain& domain, double h, const Context& context) const {
  // Tets with a vertex inside end at those one edge from it. These may be taken to be inside, too, as long as all their
  // tets are there.
  constexpr int kRings = 1;
  // Two edges and more; a cube has edges of its width.
  constexpr double kWidthsOff = 3;
  const ImplicitFunctionRef psi = domain.psi();
  const bool is_alone = graded_->n_domains() == 1;
  const double steepest = is_alone ? domain.steepest() : std::numeric_limits<double>::infinity();
  const auto sizes = sizes_for(h);
  Grading grading{.box = domain.box, .finest = h, .size = {}, .tolerance = kSizeTolerance};
  grading.size = [&](const Vec3& x, double half) { return cube_size(*sizes, x, half); };
  grading.wanted = [&](const Vec3& x, double half) {
    const bool meets_box = ((x - domain.box.center()).cwiseAbs() - .5 * domain.box.sizes()).maxCoeff() < half;
    return meets_box && !(psi.value(x) > steepest * (std::sqrt(3.) + 2 * kWidthsOff) * half);
  };
  if (!is_alone) return BackgroundMesh(GradedMesh(grading));
  const int sweeps = std::exchange(grading.transition_sweeps, 0);
  const GradedMesh all(grading);
  const std::vector<double> value =
      values_at(psi, static_cast<std::size_t>(all.n_vertices()), context,
                [&](std::size_t v) { return all.position(static_cast<std::int64_t>(v)); });
  IdSet inside(all.n_vertices());
  for (std::size_t v = 0; v < value.size(); ++v) {
    if (value[v] < 0) inside.insert(static_cast<std::int64_t>(v));
  }
  if (inside.is_empty_around(0, all.n_vertices())) return BackgroundMesh(all);
  return BackgroundMesh(all.around(inside, kRings, sweeps));
}

SizedBackground BackgroundChoice::make(const Domain& domain, double h, std::int64_t n_tets, double allowed,
                                       const Context& context) const {
  const auto expected = [&](const BackgroundMesh& background) {
    const double n = n_tets > 0 ? static_cast<double>(n_tets) : expected_tets(domain, h);
    return std::min(n, static_cast<double>(background.n_tets()));
  };
  try {
    BackgroundMesh background = given_    ? *given_
                                : graded_ ? graded(domain, h, context)
                                : walls_  ? BackgroundMesh(a15_box(domain.box, h))
                                          : BackgroundMesh(*tiling_, domain.box, h);
    require_memory(background, expected(background), allowed);
    return {std::move(background), domain.box, graded_ ? sizes_for(h) : nullptr};
  } catch (const std::invalid_argument& e) {  // h and the box have been checked: their tets are too many to count
    throw ResourceLimit(formatted("h = %.4g: no background mesh: %s", h, e.what()));
  }
}

}  // namespace umtet
