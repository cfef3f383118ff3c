#include "pipeline/mesh_measures.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "mesh/quality_report.h"
#include "mesh/skin.h"
#include "mesh/surface_distance.h"
#include "mesh/thickness.h"

namespace umtet {
namespace {

// A patch of surface this many sample spacings from any sample is a guess of the fit.
constexpr double kSupportRadius = 3;
// Values of psi a count of pieces may cost: about ten seconds.
constexpr double kMaxGridNodes = 5e7;

double grid_spacing(const Domain& domain, double wanted) {
  return std::max(wanted, std::cbrt(domain.box.volume() / kMaxGridNodes));
}

template <class T>
Json number_or_null(const std::optional<T>& v) {
  return v ? Json(*v) : Json(nullptr);
}

double rms(const std::vector<double>& d) {
  return std::sqrt(std::transform_reduce(d.begin(), d.end(), 0., std::plus<>(), [](double v) { return v * v; }) /
                   static_cast<double>(d.size()));
}

/// Largest principal curvature of psi = 0 at the boundary vertices, in magnitude, times h.
double max_curvature(ImplicitFunctionRef psi, const UmResult& result, double h) {
  const std::vector<int>& I = result.submesh.positive_vertices;
  std::vector<double> kappa(I.size());
  tbb::parallel_for(std::size_t{0}, I.size(), [&](std::size_t k) {
    Vec3 g;
    Mat3 H;
    psi.value(result.final[I[k]], g, H);
    const Vec3 n = g.normalized();
    const Mat3 P = Mat3::Identity() - n * n.transpose();
    // P H P / |grad psi| is the shape operator, with a third eigenvalue 0 along the normal.
    const Mat3 S = P * H * P / g.norm();
    kappa[k] = Eigen::SelfAdjointEigenSolver<Mat3>(S, Eigen::EigenvaluesOnly).eigenvalues().cwiseAbs().maxCoeff();
  });
  return kappa.empty() ? 0 : h * *std::max_element(kappa.begin(), kappa.end());
}

/// Least distance from a boundary vertex along the normal to the opposite sheet, inside or outside; looked for up to
/// four edges, beyond which it does not matter.
double min_feature_size(ImplicitFunctionRef psi, const UmResult& result, double h) {
  std::vector<Vec3> points;
  for (const int i : result.submesh.positive_vertices) points.push_back(result.final[i]);
  const std::vector<double> t = thickness(psi, points, h / 4, 4 * h);
  return t.empty() ? 0 : *std::min_element(t.begin(), t.end());
}

Json cloud_block(const Domain& domain, const std::vector<Vec3>& V, const std::vector<Triangle>& faces, double h) {
  if (domain.cloud.points.empty()) return nullptr;
  std::vector<double> d = SurfaceDistance(V, faces).distances(domain.cloud.points);
  std::sort(d.begin(), d.end());
  const double r = rms(d), max = d.back(), p99 = quantile(d, .99);
  return {{"rms_distance", r},
          {"max_distance", max},
          {"p99_distance", p99},
          {"rms_distance_over_h", r / h},
          {"max_distance_over_h", max / h},
          {"p99_distance_over_h", p99 / h}};
}

/// Does the boundary of the mesh look like psi = 0? Where the two counts differ, the count is repeated on a finer grid
/// before the mesh is blamed.
void compare_with_zero_set(const Domain& domain, const MeshCertificate& certificate, const ZeroSetChoice& pieces,
                           Json& block, std::vector<std::string>& reasons) {
  const auto differs = [&](const ZeroSetTopology& topology) {
    const bool all_kept = pieces.dropped.empty();
    return static_cast<int>(topology.components.size() - pieces.dropped.size()) != certificate.boundary.components ||
           (all_kept && topology.euler_characteristic != certificate.boundary.euler_characteristic);
  };
  ZeroSetTopology finer;
  const ZeroSetTopology* topology = &pieces.topology;
  if (differs(*topology)) {
    finer = zero_set_topology(domain.psi(), domain.box, grid_spacing(domain, topology->spacing / 2));
    topology = &finer;
  }
  block["components_of_zero_set"] = topology->components.size();
  block["euler_characteristic_of_zero_set"] = topology->euler_characteristic;
  block["components_meshed"] = certificate.boundary.components;
  block["components_dropped"] = pieces.dropped;
  if (differs(*topology)) {
    reasons.push_back(fmt::format(
        "psi = 0 has {} pieces ({} dropped) and Euler characteristic {} on a grid of spacing {:.3g}, the boundary of "
        "the mesh {} and {}: h is too large for this shape",
        topology->components.size(), pieces.dropped.size(), topology->euler_characteristic, topology->spacing,
        certificate.boundary.components, certificate.boundary.euler_characteristic));
  }
}

}  // namespace

ZeroSetChoice choose_components(const Domain& domain, double h) {
  ZeroSetChoice choice;
  const double wanted = domain.level_set ? std::min(h, domain.level_set->spacing()) : h;
  choice.topology = zero_set_topology(domain.psi(), domain.box, grid_spacing(domain, wanted));
  const double radius = kSupportRadius * domain.cloud_spacing;
  for (const ZeroSetComponent& piece : choice.topology.components) {
    const bool backed =
        domain.formula || std::any_of(domain.cloud.points.begin(), domain.cloud.points.end(),
                                      [&](const Vec3& x) { return piece.box.exteriorDistance(x) <= radius; });
    if (backed) {
      choice.seeds.push_back(piece.seed);
    } else {
      const Vec3 at = piece.seed + domain.shift;
      choice.dropped.push_back(fmt::format("piece of area {:.3g} at ({:.6g}, {:.6g}, {:.6g}): no sample within {:.3g}",
                                           piece.area, at.x(), at.y(), at.z(), radius));
    }
  }
  return choice;
}

Json to_json(const MeshCertificate& c) {
  return {{"n_tets", c.n_tets},
          {"n_vertices", c.n_vertices},
          {"n_positive_faces", c.n_positive_faces},
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
            {"max_centroid_distance_over_h", number_or_null(c.boundary.max_centroid_distance_over_h)},
            {"min_cos_normal", number_or_null(c.boundary.min_cos_normal)},
            {"n_cos_below_half", c.boundary.n_cos_below_half}}}};
}

Json measure(const Domain& domain, const UmResult& result, const ZeroSetChoice& pieces, double h) {
  const TetMesh mesh{result.final, result.submesh.mesh.C};
  CertificateInput input;
  input.mesh = &mesh;
  input.h = h;
  input.positive_faces = &result.submesh.positive_faces;
  input.psi = domain.psi();
  const MeshCertificate certificate = certify(input);
  std::vector<std::string> reasons = failures(certificate);

  Json json = {{"n_points", domain.formula ? Json(nullptr) : Json(domain.cloud.points.size())}};
  json.update(to_json(certificate));
  const std::vector<Triangle>& faces = result.submesh.positive_faces;
  Json block = Json::object();
  compare_with_zero_set(domain, certificate, pieces, block, reasons);
  block["unsupported_area_fraction"] = nullptr;
  if (!domain.cloud.points.empty()) {
    block["unsupported_area_fraction"] =
        unsupported_area_fraction(mesh.V, faces, domain.cloud.points, kSupportRadius * domain.cloud_spacing);
  }
  json["domain"] = std::move(block);
  json["cloud"] = cloud_block(domain, mesh.V, faces, h);
  json["resolution"] = {{"kappa_h_max", max_curvature(domain.psi(), result, h)},
                        {"feature_size_over_h_min", min_feature_size(domain.psi(), result, h) / h},
                        {"obtuse_conditioning_angles", result.obtuse_conditioning_angles},
                        {"double_positive_faces", result.double_positive_faces}};
  json["reasons"] = reasons;
  return json;
}

}  // namespace umtet
