#include "pipeline/meshing/mesh_measures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "mesh/certify/boundary_surface.h"
#include "mesh/certify/quality_report.h"
#include "mesh/implicit/surface_distance.h"
#include "mesh/implicit/thickness.h"
#include "pipeline/meshing/component_proof.h"
#include "pipeline/meshing/deviation.h"
#include "pipeline/meshing/edge_length.h"

namespace umtet {
namespace {

template <class T>
Json number_or_null(const std::optional<T>& v) {
  return v ? Json(*v) : Json(nullptr);
}

double rms(const std::vector<double>& d) {
  return std::sqrt(std::transform_reduce(d.begin(), d.end(), 0., std::plus<>(), [](double v) { return v * v; }) /
                   static_cast<double>(d.size()));
}

/// Largest principal curvature of psi = 0 at the boundary vertices, in magnitude, times h.
double max_curvature(ImplicitFunctionRef psi, const UmResult& result, double h, const Context& context) {
  const std::vector<int>& I = result.submesh.positive_vertices;
  std::vector<double> kappa(I.size());
  polled_parallel_for(I.size(), kValuesPerPoll, context,
                      [&](std::size_t k) { kappa[k] = principal_curvatures(psi, result.final[I[k]])[0]; });
  return kappa.empty() ? 0 : h * *std::max_element(kappa.begin(), kappa.end());
}

/// Least distance from a boundary vertex along the normal to the opposite sheet, inside or outside; looked for up to
/// four edges, beyond which it does not matter.
double min_feature_size(const Domain& domain, const UmResult& result, double h, const Context& context) {
  std::vector<Vec3> points;
  for (const int i : result.submesh.positive_vertices) points.push_back(result.final[i]);
  const std::vector<double> t = thickness(domain.psi(), points, h / 4, 4 * h, context, domain.steepest());
  return t.empty() ? 0 : *std::min_element(t.begin(), t.end());
}

// So many samples, and this share of them, have to be far from the mesh before it is said to lack something.
constexpr std::size_t kFewSamples = 10;
constexpr double kSmallShare = 1e-3;

/// Samples that psi, with all its detail, passes by, and the mesh does not: what has been too small for h.
void look_for_lost_samples(const Domain& domain, const std::vector<double>& d, double h, const Context& context,
                           std::vector<std::string>& reasons) {
  const std::vector<Vec3>& x = domain.cloud.points;
  std::vector<std::uint8_t> lost(x.size(), 0);
  polled_parallel_for(x.size(), kValuesPerPoll, context, [&](std::size_t i) {
    if (d[i] <= h) return;
    Vec3 g;
    const double value = domain.fitted->evaluate(x[i], &g, nullptr);
    lost[i] = d[i] > h + std::abs(value) / g.norm();
  });
  const auto n = static_cast<std::size_t>(std::count(lost.begin(), lost.end(), 1));
  if (n <= kFewSamples || static_cast<double>(n) <= kSmallShare * static_cast<double>(x.size())) return;
  std::size_t farthest = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (lost[i] && (!lost[farthest] || d[i] > d[farthest])) farthest = i;
  }
  const Vec3 at = x[farthest] + domain.shift;
  reasons.push_back(
      fmt::format("{} samples of the surface are farther than h from the mesh, that at ({:.6g}, {:.6g}, "
                  "{:.6g}) {:.2g} h: h is too large for what is there",
                  n, at.x(), at.y(), at.z(), d[farthest] / h));
}

Json cloud_block(const Domain& domain, const std::vector<Vec3>& V, const std::vector<Triangle>& faces, double h,
                 const Context& context, std::vector<std::string>& reasons) {
  if (domain.cloud.points.empty() || faces.empty()) return nullptr;  // no face: the body fell through the background
  std::vector<double> d = SurfaceDistance(V, faces).distances(domain.cloud.points, context);
  if (domain.fitted) look_for_lost_samples(domain, d, h, context, reasons);
  std::sort(d.begin(), d.end());
  const double r = rms(d), max = d.back(), p99 = quantile(d, .99);
  return {{"noise", number_or_null(domain.noise)},
          {"noise_over_h", domain.noise ? Json(*domain.noise / h) : Json(nullptr)},
          {"rms_distance", r},
          {"max_distance", max},
          {"p99_distance", p99},
          {"rms_distance_over_h", r / h},
          {"max_distance_over_h", max / h},
          {"p99_distance_over_h", p99 / h}};
}

// Halving the spacing is worth its cost if it leaves at least this much of a refinement within the nodes allowed.
constexpr double kWorthRepeating = .9;

/// Does the boundary of the mesh look like the pieces of psi = 0 that are kept, and the walls of the box around a
/// fluid, one closed piece without a hole? Where the two counts differ, the count is repeated on a grid of half the
/// spacing, as far as its size is allowed, before the mesh is blamed.
void compare_with_zero_set(const Domain& domain, const MeshCertificate& certificate, const ZeroSetChoice& pieces,
                           const Context& context, Json& block, std::vector<std::string>& reasons) {
  const MeshCertificate::Boundary& boundary = certificate.boundary;
  const int of_psi = boundary.components - (domain.complement ? 1 : 0);
  const long characteristic = boundary.euler_characteristic - (domain.complement ? 2 : 0);
  const auto differs = [&](const ZeroSetChoice& c) {
    return static_cast<int>(c.seeds.size()) != of_psi || c.euler_characteristic != characteristic;
  };
  ZeroSetChoice repeated;
  const ZeroSetChoice* counted = &pieces;
  const double half = pieces.topology.spacing / 2;
  if (differs(pieces) && counting_spacing(domain, half) < kWorthRepeating * pieces.topology.spacing) {
    repeated = choose_components(domain, half, context, pieces.cells ? &*pieces.cells : nullptr);
    counted = &repeated;
  }
  block["components_of_zero_set"] = counted->topology.components.size();
  block["euler_characteristic_of_zero_set"] = counted->topology.euler_characteristic;
  block["euler_characteristic_of_kept_components"] = counted->euler_characteristic;
  block["components_meshed"] = of_psi;
  block["components_dropped"] = counted->dropped;
  if (!differs(*counted)) return;
  const double spacing = counted->topology.spacing;
  // A count on a grid coarser than the mesh is as likely to be wrong as the mesh.
  const char* verdict = spacing > certificate.h
                            ? "which of the two is wrong is open: the grid is coarser than the mesh, "
                              "and as fine as its size is allowed to be"
                            : "h is too large for this shape";
  reasons.push_back(
      fmt::format("psi = 0 has {} pieces (and {} dropped ones) of Euler characteristic {} on a grid of spacing {:.3g}, "
                  "the boundary of the mesh {}{} of {}: {}",
                  counted->seeds.size(), counted->dropped.size(), counted->euler_characteristic, spacing, of_psi,
                  domain.complement ? " besides the walls" : "", characteristic, verdict));
}

}  // namespace

void check_deviation(double asked, Json& measured) {
  const Json& d = measured.at("boundary").at("max_centroid_distance_over_h");
  if (asked == 0 || !d.is_number()) return;
  const double made = d.get<double>() * measured.at("h").get<double>();
  if (made <= asked) return;
  measured["reasons"].push_back(
      fmt::format("a face centre is {:.4g} from psi = 0, more than the {:.4g} of --max-deviation", made, asked));
}

bool is_only_coarse(const Json& measured) {
  const Json& gap = measured.at("boundary").at("gap_over_volume");
  return measured.at("reasons").size() == 1 && gap.is_number() && gap.get<double>() > kMostGap;
}

void check_lost(const Domain& domain, const UmResult& result, const ThinPlaces& thin, Json& measured,
                const Context& context) {
  measured["resolution"]["too_thin"] = to_json(thin, domain.shift);
  const LostPoint lost = lost_of(thin, result.final, result.submesh.positive_faces, context);
  if (lost.count == 0) return;
  const Vec3 at = lost.where + domain.shift;
  measured["reasons"].push_back(
      fmt::format("the mesh lacks what is thin around ({:.6g}, {:.6g}, {:.6g}): psi = 0 is "
                  "{:.2g} h from its boundary there",
                  at.x(), at.y(), at.z(), lost.distance / thin.h));
}

Json to_json(const MeshCertificate& c) {
  return {{"n_tets", c.n_tets},
          {"n_vertices", c.n_vertices},
          {"n_positive_faces", c.boundary.equals_positive_faces ? Json(c.n_positive_faces) : Json(nullptr)},
          {"n_wall_faces", c.n_wall_faces},
          {"h", c.h},
          {"volume", c.volume},
          {"quality",
           {{"min", c.quality.min},
            {"p001", c.quality.p001},
            {"p01", c.quality.p01},
            {"mean", c.quality.mean},
            {"dihedral_min_deg", c.quality.dihedral_min_deg},
            {"dihedral_max_deg", c.quality.dihedral_max_deg},
            {"n_inverted", c.quality.n_inverted}}},
          {"boundary",
           {{"closed_manifold", c.boundary.closed_manifold},
            {"equals_positive_faces", number_or_null(c.boundary.equals_positive_faces)},
            {"components", c.boundary.components},
            {"euler_characteristic", c.boundary.euler_characteristic},
            {"genus", c.boundary.genus},
            {"n_faces", c.boundary.n_faces},
            {"area", c.boundary.area},
            {"max_vertex_distance_over_h", number_or_null(c.boundary.max_vertex_distance_over_h)},
            {"coordinate_rounding_over_h", c.coordinate_rounding / c.h},
            {"max_centroid_distance_over_h", number_or_null(c.boundary.max_centroid_distance_over_h)},
            {"min_cos_normal", number_or_null(c.boundary.min_cos_normal)},
            {"gap_over_volume", number_or_null(c.boundary.gap_over_volume)},
            {"n_cos_below_half", c.boundary.n_cos_below_half}}}};
}

Json measure(const Domain& domain, const UmResult& result, const ZeroSetChoice& pieces, double h,
             const Context& context) {
  const TetMesh mesh{result.final, result.submesh.mesh.C};
  CertificateInput input;
  input.mesh = &mesh;
  input.h = h;
  input.positive_faces = &result.submesh.positive_faces;
  if (!result.walls.empty()) {
    input.wall_faces = &result.walls;
    input.background_V = &result.submesh.mesh.V;
  }
  input.psi = domain.psi();
  input.coordinate_rounding = coordinate_rounding(domain);
  input.context = context;
  const MeshCertificate certificate = certify(input);
  std::vector<std::string> reasons = failures(certificate);

  Json json = {{"n_points", domain.level_set ? Json(domain.cloud.points.size()) : Json(nullptr)}};
  json.update(to_json(certificate));
  const std::vector<Triangle>& faces = result.submesh.positive_faces;
  Json block = Json::object();
  block["level_set_spacing"] = domain.level_set ? Json(domain.level_set->spacing()) : Json(nullptr);
  compare_with_zero_set(domain, certificate, pieces, context, block, reasons);
  block["components_proved"] = nullptr;
  if (domain.level_set && pieces.cells) {
    const ComponentProof proof = prove_components(*domain.level_set, domain.box, pieces.topology, *pieces.cells);
    block["components_proved"] = proof.unseen.empty() && proof.n_open == 0;
    for (const Vec3& at : proof.unseen) {
      const Vec3 x = at + domain.shift;
      block["components_dropped"].push_back(
          fmt::format("piece at ({:.6g}, {:.6g}, {:.6g}): smaller than an edge", x.x(), x.y(), x.z()));
    }
  }
  block["unsupported_area_fraction"] = nullptr;
  if (domain.samples) {
    block["unsupported_area_fraction"] =
        unsupported_area_fraction(mesh.V, faces, *domain.samples, kSupportRadius * domain.cloud_spacing, context);
  }
  json["domain"] = std::move(block);
  json["cloud"] = cloud_block(domain, mesh.V, faces, h, context, reasons);
  json["resolution"] = {{"kappa_h_max", max_curvature(domain.psi(), result, h, context)},
                        {"feature_size_over_h_min", min_feature_size(domain, result, h, context) / h},
                        {"obtuse_conditioning_angles", result.obtuse_conditioning_angles},
                        {"double_positive_faces", result.double_positive_faces}};
  json["reasons"] = reasons;
  return json;
}

}  // namespace umtet
