#include "body/fidelity/zero_set_comparison.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "body/fidelity/closed_holes.h"
#include "body/pieces/component_proof.h"
#include "common/formatted.h"
#include "mesh/sizes/graded_zero_set.h"

namespace umtet {
namespace {

// A count is repeated only if the bound on nodes lets the new spacing be less than this share of the former one; on a
// graded mesh, where it makes four times as many, if there are fewer than this many edges.
constexpr double kWorthRepeating = .9;
constexpr std::size_t kMostRepeated = 10'000'000;

constexpr double kRightAngle = 89;  // degrees: edges of 90 degrees are not acute within the error of their curve
// In h: a piece or a handle of psi = 0 that the mesh lacks has points farther from the mesh.
constexpr double kShown = .5;

/// Returns the point where the thickness is the smallest share of the longest edge on which psi = 0 was counted there,
/// if it is less than this edge. The longest edges of a grid are the diagonals of its cubes.
/// @param sizes  of a graded mesh, or null
std::optional<Vec3> unseen_thickness(const PointThickness& thickness, const ZeroSetChoice& counted,
                                     const SizeField* sizes) {
  std::optional<Vec3> worst;
  double least = 1;
  for (std::size_t i = 0; i < thickness.points.size(); ++i) {
    const double edge = sizes ? kLongestCountedEdge * counted.share * sizes->at(thickness.points[i])
                              : std::sqrt(3.) * counted.topology.spacing;
    if (thickness.thickness[i] < least * edge) least = thickness.thickness[i] / edge, worst = thickness.points[i];
  }
  return worst;
}

/// Whether a curve has an acute edge of the body or of the space around it. Beside such an edge, body or gap are
/// thinner than any spacing, and a count can be wrong there on the finest grid: the points of a grid in a wedge are
/// separate pieces where no edge of the grid between them stays inside.
bool has_acute_edge(const PiecewiseMesh& mesh) {
  return std::any_of(mesh.graph.curves.begin(), mesh.graph.curves.end(), [](const FeatureCurve& c) {
    return std::any_of(c.angle_deg.begin(), c.angle_deg.end(),
                       [](double angle) { return angle < kRightAngle || angle > 360 - kRightAngle; });
  });
}

/// Another count, on edges half as long, if it is worth it.
std::optional<ZeroSetChoice> finer_count(const Domain& domain, const ZeroSetChoice& pieces,
                                         const ComparisonParams& params, const Context& context) {
  const SignCells* cells = pieces.cells ? &*pieces.cells : nullptr;
  if (params.sizes) {
    if (pieces.topology.cut_points.size() > kMostRepeated) return std::nullopt;
    return choose_components(domain, *params.sizes, params.h.nominal(), pieces.share / 2, context, cells);
  }
  const double half = pieces.topology.spacing / 2;
  if (counting_spacing(domain, half) >= kWorthRepeating * pieces.topology.spacing) return std::nullopt;
  return choose_components(domain, half, context, cells);
}

/// Compares the counts: compare_with_domain() without the proof and the support.
ZeroSetComparison compare_with_zero_set(const Domain& domain, const MeshCertificate& certificate,
                                        const ZeroSetChoice& pieces, const ComparisonParams& params,
                                        const Context& context) {
  const MeshCertificate::Boundary& boundary = certificate.boundary;
  const int of_psi = boundary.components - (domain.complement ? 1 : 0);
  const long characteristic = boundary.euler_characteristic - (domain.complement ? 2 : 0);
  const auto differs = [&](const ZeroSetChoice& c) {
    return static_cast<int>(c.seeds.size()) != of_psi || c.euler_characteristic != characteristic;
  };
  const std::optional<ZeroSetChoice> repeated =
      differs(pieces) ? finer_count(domain, pieces, params, context) : std::nullopt;
  const ZeroSetChoice* counted = repeated ? &*repeated : &pieces;
  ZeroSetComparison made;
  ZeroSetReport& report = made.report;
  report.counting_spacing = counted->share > 0
                                ? kLongestCountedEdge / std::sqrt(3.) * counted->share * params.h.nominal()
                                : counted->topology.spacing;
  report.components_of_zero_set = counted->topology.components.size();
  report.euler_characteristic_of_zero_set = counted->topology.euler_characteristic;
  report.components_kept = counted->seeds.size();
  report.euler_characteristic_of_kept_components = counted->euler_characteristic;
  report.components_meshed = of_psi;
  report.euler_characteristic_meshed = characteristic;
  report.components_dropped = counted->dropped;
  if (!differs(*counted)) {
    if (const auto where = unseen_thickness(params.thickness, *counted, params.sizes)) {
      report.topology = TopologyProof::NotProved;
      report.topology_at = *where + domain.shift;
    }
    return made;
  }
  const auto n_pieces = static_cast<std::size_t>(std::abs(static_cast<int>(counted->seeds.size()) - of_psi));
  const auto n_handles = static_cast<std::size_t>(std::abs(counted->euler_characteristic - characteristic) / 2);
  const std::size_t n = std::max<std::size_t>(1, n_pieces + n_handles);
  MeshDefect defect{.kind = DefectKind::Topology, .n = n};
  if (params.surface) defect = topology_defect(domain, *counted, *params.surface, params.h, n, context);
  const bool is_coarser = counted->share == 0 && counted->topology.spacing > params.h.least();
  const bool is_wedge = params.features && has_acute_edge(*params.features) && defect.off_over_h < kShown;
  const bool is_unsure = is_coarser || is_wedge;
  report.topology = is_unsure ? TopologyProof::NotProved : TopologyProof::Differs;
  report.topology_at = defect.where;
  if (report.topology == TopologyProof::Differs) made.defect = defect;
  return made;
}

}  // namespace

ZeroSetComparison compare_with_domain(const Domain& domain, const TetMesh& mesh, const std::vector<Triangle>& faces,
                                      const MeshCertificate& certificate, const ZeroSetChoice& pieces,
                                      const ComparisonParams& params, const Context& context) {
  ZeroSetComparison made = compare_with_zero_set(domain, certificate, pieces, params, context);
  ZeroSetReport& report = made.report;
  if (domain.level_set) report.level_set_spacing = domain.level_set->spacing();
  if (domain.level_set && pieces.cells) {
    const ComponentProof proof = prove_components(*domain.level_set, domain.box, pieces.topology, *pieces.cells);
    report.components_proved = proof.unseen.empty() && proof.n_open == 0;
    for (const Vec3& at : proof.unseen) {
      const Vec3 x = at + domain.shift;
      report.components_dropped.push_back(
          formatted("piece at (%.6g, %.6g, %.6g): smaller than an edge", x.x(), x.y(), x.z()));
    }
  }
  if (domain.has_samples()) report.support = support_report(domain, mesh.V, faces, context);
  return made;
}

}  // namespace umtet
