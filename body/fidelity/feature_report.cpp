#include "body/fidelity/feature_report.h"

#include <algorithm>
#include <set>

#include "body/sizing/sheets.h"
#include "mesh/features/feature_embedding.h"
#include "mesh/features/feature_measures.h"

namespace umtet {
namespace {

// More tets than this at an edge are no better: Q_max of 360 degrees is largest for five.
constexpr int kMostAtEdge = 6;
// psi is followed in steps of this many edges, as far as kFollowReach edges, to see how thin the body is at a defect.
constexpr double kFollowStep = .125, kFollowReach = 2;

double best_quality_at(double angle_deg) {
  double best = 0;
  for (int k = 1; k <= kMostAtEdge; ++k) best = std::max(best, best_wedge_quality(angle_deg, k));
  return best;
}

/// The corners that a curve without a path ends at: they are defects of the curve.
std::set<int> ends_of_missed_curves(const PiecewiseMesh& mesh) {
  std::set<int> ends;
  for (std::size_t c = 0; c < mesh.chains.size(); ++c)
    if (mesh.chains[c].empty()) ends.insert(mesh.graph.curves[c].ends.begin(), mesh.graph.curves[c].ends.end());
  return ends;
}

}  // namespace

FeatureReport feature_report(const PiecewiseDomain& body, const PiecewiseMesh& mesh) {
  const FeatureMeasures m = measure_features(body, mesh);
  FeatureReport report;
  std::set<int> patches(mesh.face_patch.begin(), mesh.face_patch.end());
  patches.erase(-1);
  report.n_patches = patches.size();
  report.n_corners = m.n_corners;
  report.n_curves = m.n_curves;
  report.n_missed_corners = m.n_missed_corners;
  report.n_missed_curves = m.n_missed_curves;
  report.length = m.length;
  report.missed_length = m.missed_length;
  report.max_vertex_over_h = m.farthest_vertex;
  report.max_curve_over_h = m.farthest_point;
  report.max_angle_off_deg = m.worst_angle_deg;
  report.min_cos_normal = m.least_cosine;
  report.n_faces_without_patch = m.n_faces_without_patch;
  for (const FeatureCurve& curve : mesh.graph.curves) {
    for (const double angle : curve.angle_deg) {
      report.min_angle_deg = std::min(report.min_angle_deg, angle);
      report.wedge_quality = std::min(report.wedge_quality, best_quality_at(angle));
    }
  }
  return report;
}

std::vector<MeshDefect> missed_features(const Domain& domain, const PiecewiseMesh& mesh,
                                        const SurfaceDistance& boundary, const MeshEdge& h, const Context& context) {
  std::vector<MeshDefect> missed;
  std::vector<Vec3> at;
  const auto add = [&](const std::vector<Vec3>& points) {
    MeshDefect defect{.kind = DefectKind::Edges};
    double farthest = -1;
    Box box;
    for (const Vec3& x : points) {
      box.extend(x);
      const double off = boundary.distance(x);
      if (off > farthest) farthest = off, defect.where = x;
    }
    const double h_at = h.at(defect.where);
    defect.off_over_h = farthest / h_at;
    defect.size_over_h = box.diagonal().norm() / h_at;
    at.push_back(defect.where);
    missed.push_back(defect);
  };
  for (std::size_t c = 0; c < mesh.chains.size(); ++c)
    if (mesh.chains[c].empty()) add(mesh.graph.curves[c].points);
  const std::set<int> ends = ends_of_missed_curves(mesh);
  for (std::size_t c = 0; c < mesh.corner_vertex.size(); ++c) {
    if (mesh.corner_vertex[c] < 0 && ends.count(static_cast<int>(c)) == 0) add({mesh.graph.corners[c].place});
  }
  for (const FeatureDefect& d : mesh.graph.defects) add({d.where});
  const std::vector<double> thickness = body_thickness(domain, at, h.at(at), kFollowStep, kFollowReach, context);
  for (std::size_t i = 0; i < missed.size(); ++i) {
    const double h_at = h.at(at[i]);
    if (thickness[i] < kFollowReach * h_at) {
      missed[i].feature_over_h = thickness[i] / h_at;
      missed[i].h_needed = thickness[i] / kLeastEdgesAcross;
    }
    missed[i].where += domain.shift;
  }
  return missed;
}

}  // namespace umtet
