#include "body/sizing/edge_length.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "body/errors.h"
#include "body/label_volume.h"
#include "body/option_names.h"
#include "body/pieces/zero_set_choice.h"
#include "body/sizing/background_choice.h"
#include "body/sizing/deviation.h"
#include "body/sizing/sheet_support.h"
#include "body/sizing/thick_body.h"
#include "common/formatted.h"
#include "mesh/certify/quality_report.h"
#include "mesh/implicit/foot_point.h"
#include "mesh/implicit/thickness.h"
#include "mesh/sizes/body_size.h"
#include "reconstruct/cloud/cloud_arrays.h"
#include "reconstruct/solve/resolution.h"

namespace umtet {
namespace {

// Where that makes more than kTetsOfLargeMesh tets, fewer edges across have to do: classification and repair mend what
// comes out wrong down to about 1.9, and (1.9 / 2.2)^3 is two thirds of the tets.
constexpr double kFewerEdgesAcross = 1.9;
// Of a volume that is known: a third of the 3 % that a mesh of a segmentation may differ by.
constexpr double kLostVolume = .01;
// A mesh of a segmentation has edges of this share of a voxel or more, as far as its body is not thin: psi has waves of
// two voxels and longer.
constexpr double kLeastOfVoxel = .5;
constexpr double kThinShare = .01;  // that is thinner than what h is chosen for
// The most that rounding may move a vertex, in edges: far less than anything that counts in a mesh.
constexpr double kMostRounding = 1e-6;
// 200 of them fall below the first percentile.
constexpr std::size_t kThicknessSamples = 20000;

/// \throw MeshingImpossible when psi < 0 at none of the places where it is sampled
double h_of(const Domain& domain, const BodyOptions& options, std::int64_t n_tets) {
  try {
    return h_for_tets(tiling_of(options.mesh), domain.size(), static_cast<double>(n_tets),
                      classification_source(options));
  } catch (const std::invalid_argument& e) {
    throw MeshingImpossible(std::string("no edge length can be chosen: ") + e.what(),
                            {{Change::Give, option::h}, {Change::Give, option::box, "around the place where psi < 0"}});
  }
}

/// \throw ResourceLimit
void refuse_too_many(const Domain& domain, const BodyOptions& options, double h) {
  const std::int64_t max_tets = options.mesh.max_tets;
  double least = 0;
  try {
    least = h_of(domain, options, max_tets);
  } catch (const MeshingImpossible&) {
    return;  // the domain is smaller than the grid of the estimate: so are its tets few
  }
  // The estimate is good to 10 % in the number of tets, which is 3 % in h.
  if (h >= .97 * least) return;
  throw ResourceLimit(formatted("h = %.4g makes more than %lld tets (that many at h = %.4g)", h,
                                static_cast<long long>(max_tets), least),
                      {{Change::Raise, option::max_tets}});
}

struct ThinPart {
  double thickness;  ///< that a hundredth of the samples fall below, at most the limit
  double faces = 1;  ///< mean of (that / thickness)^2: about the share of faces that edges in proportion would make
};

/// Limits thickness to what samples show on both sides. @param t  thickness at the samples, at most the limit
void leave_out_guesses(const Domain& domain, ImplicitFunctionRef psi, const std::vector<Vec3>& samples, double step,
                       double limit, const Context& context, std::vector<double>& t) {
  std::vector<std::size_t> thin;
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < t.size(); ++i)
    if (t[i] < limit) thin.push_back(i), points.push_back(samples[i]);
  if (thin.empty() || domain.cloud.normals.size() != domain.cloud.points.size()) return;
  const SheetSupport is_supported(domain);
  const std::vector<SheetDistances> sheets = sheet_distances(psi, points, step, limit, context, domain.steepest());
  for (std::size_t k = 0; k < thin.size(); ++k) {
    const Foot foot = foot_point(psi, points[k], step);
    if (!foot.found) continue;
    t[thin[k]] = limit;
    for (const auto& [side, distance] : {std::pair{-1., sheets[k].body}, std::pair{1., sheets[k].gap}}) {
      if (!(distance < limit)) continue;
      const Vec3 other = foot.point + side * distance * foot.normal;
      Vec3 gradient;
      psi.value(other, gradient);
      if (is_supported(other, gradient)) t[thin[k]] = std::min(t[thin[k]], distance);
    }
  }
}

/// Samples of psi = 0, evenly: clouds are sorted in space, and crossings of a segmentation by layers.
std::vector<Vec3> samples_of(const Domain& domain) {
  if (domain.labels) {
    const std::vector<Vec3>& all = domain.labels->surface;
    std::vector<Vec3> samples;
    for (std::size_t i = 0; i < all.size(); i += all.size() / kThicknessSamples + 1) samples.push_back(all[i]);
    return samples;
  }
  const std::vector<Vec3>& all = domain.cloud.points;
  const std::vector<int>& counts = domain.cloud.counts;
  const std::size_t n = sum_of_counts(counts, all.size());
  std::vector<Vec3> samples;
  for (const std::size_t i :
       every_mth(n / kThicknessSamples + 1, all.size(), [&](std::size_t row) { return count_of(counts, row); }))
    samples.push_back(all[i]);
  return samples;
}

ThinPart thin_part(const Domain& domain, double limit, const Context& context) {
  // psi has no sheets much closer together than its lattice.
  const std::vector<Vec3> samples = samples_of(domain);
  const double step = .25 * (domain.labels ? domain.labels->step() : domain.level_set->spacing());
  std::vector<double> t = domain.with_psi_apart([&](ImplicitFunctionRef psi) {
    std::vector<double> all = thickness(psi, samples, step, limit, context, domain.steepest());
    if (domain.level_set) leave_out_guesses(domain, psi, samples, step, limit, context, all);
    return all;
  });
  std::sort(t.begin(), t.end());
  const double thin = quantile(t, kThinShare);
  double faces = 0;
  for (const double x : t) faces += std::pow(thin / std::max(x, thin), 2) / static_cast<double>(t.size());
  return {thin, faces};
}

// So many tets are enough for a body that is thin all over, where it is made of two layers pressed flat (thick_body.h):
// a plate of a hundredth of its diagonal has one edge across then. What the thickened rims take comes on top.
constexpr double kTetsOfThinShape = 120'000;
// Of the triangles: thinner parts are less than what a mesh is chosen for.
constexpr double kThinTriangles = .005;

/// Of triangles, which say where a body is thin; psi may be thinner where it is fitted badly. However thin it is, two
/// layers of tets go through: h follows the number of tets.
EdgeLength of_triangles(Domain& domain, const BodyOptions& options, const Context& context) {
  const double of_size = kMeshEdge * domain.diagonal;
  const double least = h_of(domain, options, options.mesh.max_tets);
  const TriangleThickness thickness = triangle_thickness(domain, kEdgesAcross * of_size, context);
  const double thin = thickness.share(kThinTriangles);
  double h = of_size;
  if (thin < kEdgesAcross * of_size) {
    const auto n_tets = [&](double edge) {
      return expected_tets(tiling_of(options.mesh), thickened_size(domain.size(), thickness, edge), edge,
                           classification_source(options));
    };
    double low = thin / kEdgesAcross, high = of_size;
    if (n_tets(low) <= kTetsOfThinShape) high = low;
    while (high > 1.01 * low) {
      const double middle = std::sqrt(low * high);
      (n_tets(middle) > kTetsOfThinShape ? low : high) = middle;
    }
    h = high;
  }
  h = std::max(h, least);
  return {.h = h, .least = least};
}

/// The h at which flat faces cut off at most a share kLostVolume of a segmentation: triangles with edges of h and
/// corners on a surface lie h^2 (k1 + k2) / 16 below it in the mean.
double edge_of_volume(const LabelVolume& labels) {
  const double bulge = std::abs(labels.mean_curvature);
  if (!(bulge > 0)) return std::numeric_limits<double>::infinity();
  return std::sqrt(16 * kLostVolume * labels.report.volume_of_psi / bulge);
}

/// By curvature. \throw ResourceLimit
EdgeLength by_deviation(Domain& domain, const BodyOptions& options, double deviation, const Context& context) {
  const std::int64_t max_tets = options.mesh.max_tets;
  const double least = h_of(domain, options, max_tets);
  const double h = h_for_deviation(domain, deviation, kMostOfDiagonal * domain.diagonal, least, context);
  if (h > least) return {h, least};
  throw ResourceLimit(
      {Setting(option::max_deviation, formatted("%.4g", deviation)),
       formatted(" needs more than %lld tets (that many at h = %.4g)", static_cast<long long>(max_tets), least)},
      {{Change::Raise, option::max_tets}});
}

/// The choice, without regard to how it will be written.
EdgeLength choose(Domain& domain, const BodyOptions& options, const Context& context) {
  const MeshOptions& p = options.mesh;
  if (p.tets == 0 && p.h > 0) {
    refuse_too_many(domain, options, p.h);
    return {p.h, p.h};
  }
  if (p.tets == 0 && p.max_deviation > 0) return by_deviation(domain, options, p.max_deviation, context);
  if (p.tets == 0 && may_be_thickened(domain, options)) return of_triangles(domain, options, context);
  const double of_diagonal = kMeshEdge * domain.diagonal;
  // The voxels have nothing finer, unless a part is thin.
  const double of_size = domain.labels ? std::min(std::max(of_diagonal, kLeastOfVoxel * domain.labels->step()),
                                                  edge_of_volume(*domain.labels))
                                       : of_diagonal;
  const double limit = kEdgesAcross * of_size;
  const ThinPart thin = domain.level_set || domain.labels ? thin_part(domain, limit, context) : ThinPart{limit};
  const double t = thin.thickness;
  const double of_noise = noise_edge(domain), needed = std::max(std::min(of_size, t / kEdgesAcross), of_noise);
  if (p.tets > 0) {
    const double h = h_of(domain, options, p.tets);
    return {.h = h, .least = h, .needed = needed, .graded_faces = thin.faces};
  }
  const double least = h_of(domain, options, p.max_tets);
  double h = edge_length_by(of_size, t, [&] { return h_of(domain, options, kTetsOfLargeMesh); });
  const bool at_max_tets = least > std::max(h, of_noise);
  h = std::max(h, least);
  const std::optional<double> of_thin_parts = of_noise > h ? std::optional(h) : std::nullopt;
  return {.h = std::max(h, of_noise),
          .least = least,
          .of_thin_parts = of_thin_parts,
          .needed = needed,
          .at_max_tets = at_max_tets,
          .graded_faces = thin.faces};
}

Vec3 greatest_coordinates(const Domain& domain) {
  return (domain.box.min() + domain.shift).cwiseAbs().cwiseMax((domain.box.max() + domain.shift).cwiseAbs());
}

}  // namespace

double edge_length_by(double of_size, double thin, const std::function<double()>& of_large) {
  if (!(thin < kEdgesAcross * of_size)) return of_size;
  return std::min(of_size, std::clamp(of_large(), thin / kEdgesAcross, thin / kFewerEdgesAcross));
}

double coordinate_rounding(const Domain& domain) {
  // Half a unit in the last place on every axis.
  const Vec3 rounding = greatest_coordinates(domain).unaryExpr(
      [](double x) { return .5 * (std::nextafter(x, std::numeric_limits<double>::infinity()) - x); });
  return rounding.norm();
}

double least_h_of_max_tets(const Domain& domain, const BodyOptions& options) {
  return h_of(domain, options, options.mesh.max_tets);
}

double least_h_in_file(const Domain& domain) { return coordinate_rounding(domain) / kMostRounding; }

double noise_edge(const Domain& domain) { return domain.noise.value_or(0) / kMostNoise; }

EdgeLength choose_edge_length(Domain& domain, const BodyOptions& options, const Context& context) {
  return representable(choose(domain, options, context), domain);
}

EdgeLength representable(EdgeLength choice, const Domain& domain) {
  const double least = least_h_in_file(domain);
  if (choice.h < least) {
    const double far = greatest_coordinates(domain).maxCoeff();
    std::vector<Remedy> remedies;
    if (least < kMeshEdge * 10 * domain.diagonal)
      remedies.push_back({Change::Give, {option::h, formatted("%.3g", least)}, "or more"});
    throw MeshingImpossible(
        formatted("h = %.4g is too small for coordinates of %.3g: they are rounded to multiples of %.2g in any file of "
                  "doubles, and boundary vertices would miss psi = 0 by more than %g h; move the input nearer to the "
                  "origin",
                  choice.h, far, std::nextafter(far, std::numeric_limits<double>::infinity()) - far, kMostRounding),
        remedies);
  }
  choice.least = std::max(choice.least, least);
  return choice;
}

}  // namespace umtet
