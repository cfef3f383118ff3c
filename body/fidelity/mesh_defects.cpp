#include "body/fidelity/mesh_defects.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "body/fidelity/lost_ends.h"
#include "body/fidelity/lost_surface.h"
#include "body/pieces/clusters.h"
#include "body/sizing/sheets.h"
#include "common/polled_loops.h"
#include "mesh/core/asking_psi.h"
#include "mesh/implicit/curvature.h"
#include "mesh/implicit/foot_point.h"
#include "reconstruct/cloud/neighbours/neighbour_tree.h"

namespace umtet {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// psi is followed in steps of this many edges, as far as kReach edges: what is larger explains nothing.
constexpr double kStep = .125, kReach = 2;
// The middle of a face with edges of h is this many h from the sphere through its corners whose diameter is
// kLeastEdgesAcross h: r - sqrt(r^2 - 1/3).
const double kFlat = kLeastEdgesAcross / 2 - std::sqrt(kLeastEdgesAcross * kLeastEdgesAcross / 4 - 1. / 3);
/// How small psi = 0 is near each point, model units; infinite beyond kReach h.
std::vector<double> features(const Domain& domain, const std::vector<Vec3>& points, const std::vector<double>& h,
                             const Context& context) {
  const ImplicitFunctionRef psi = domain.body();
  std::vector<double> f = body_thickness(domain, points, h, kStep, kReach, context);
  for_each_asking(psi, points.size(), kValuesPerPoll / 8, context, [&](std::size_t i) {
    // A vertex that has stopped short of psi = 0 is not where its curvature counts.
    const Foot foot = foot_point(psi, points[i], h[i]);
    const double k = principal_curvatures(psi, foot.found ? foot.point : points[i])[0];
    if (k > 0) f[i] = std::min(f[i], 2 / k);
    if (!(f[i] < kReach * h[i])) f[i] = kInfinity;
  });
  return f;
}

void set_feature(double feature, double h, MeshDefect& defect) {
  if (!(feature < kInfinity)) return;
  defect.feature_over_h = feature / h;
  defect.h_needed = feature / kLeastEdgesAcross;
}

}  // namespace

std::vector<Difference> differences_of(const MeshCertificate& certificate) {
  std::vector<Difference> all;
  for (const BoundaryFault& fault : certificate.boundary.faults) {
    all.push_back({fault.kind == BoundaryFault::Kind::Folded ? DefectKind::Folded : DefectKind::Off, fault.where,
                   fault.distance});
  }
  return all;
}

std::vector<Difference> lost_parts(const Domain& domain, const std::vector<Vec3>& psi_points,
                                   const std::vector<Vec3>& starts, const SurfaceDistance& boundary, const MeshEdge& h,
                                   const Context& context) {
  std::vector<LostPoint> seeds = lost_ends(domain, starts, boundary, h, kSmallOff, context);
  const std::vector<double> d = boundary.distances(psi_points, context);
  for (std::size_t i = 0; i < d.size(); ++i) {
    if (d[i] <= kSmallOff * h.least()) continue;
    const double h_at = h.at(psi_points[i]), beyond = kSmallOff * h_at;
    if (d[i] <= beyond) continue;
    // The grid takes psi for linear.
    const Foot foot = foot_point(domain.body(), psi_points[i], h_at);
    if (!foot.found) continue;
    if (const double off = boundary.distance(foot.point); off > beyond) {
      seeds.push_back({foot.point, off});
    }
  }
  std::vector<Difference> lost;
  for (const LostPoint& point : lost_surface(domain, std::move(seeds), boundary, h, kSmallOff, context)) {
    lost.push_back({DefectKind::Thin, point.where, point.distance});
  }
  return lost;
}

std::vector<Difference> flips_that_show(const std::vector<ManifoldFlip>& flips, const std::vector<Vec3>& psi_points,
                                        const SurfaceDistance& boundary, const MeshEdge& h, const Context& context) {
  std::vector<Difference> all;
  if (flips.empty() || psi_points.empty()) return all;
  const NeighbourTree tree(psi_points);
  for (const ManifoldFlip& flip : flips) {
    context.poll();
    Difference farthest{flip.is_filled ? DefectKind::Filled : DefectKind::Cut, flip.where, 0};
    const double h_at = h.at(flip.where);
    tree.within(flip.where, h_at * h_at, [&](std::uint32_t i, double) {
      const double d = boundary.distance(psi_points[i]);
      if (d > farthest.off) farthest.where = psi_points[i], farthest.off = d;
    });
    if (farthest.off > kFlat * h_at) all.push_back(farthest);
  }
  return all;
}

MeshDefect topology_defect(const Domain& domain, const ZeroSetChoice& counted, const SurfaceDistance& boundary,
                           const MeshEdge& h, std::size_t n, const Context& context) {
  const std::vector<Vec3> points = kept_points(counted);
  MeshDefect defect;
  defect.kind = DefectKind::Topology;
  defect.n = n;
  if (points.empty()) return defect;
  const std::vector<double> h_at = h.at(points);
  const std::vector<double> t = body_thickness(domain, points, h_at, kStep, kReach, context);
  const std::vector<double> d = boundary.distances(points, context);
  const auto is_thin = [&](std::size_t i) { return t[i] < kLeastEdgesAcross * h_at[i]; };
  std::size_t at = 0;
  double off_over_h = 0, feature = kInfinity;
  for (std::size_t i = 0; i < points.size(); ++i) {
    off_over_h = std::max(off_over_h, d[i] / h_at[i]);
    if (is_thin(i) > is_thin(at) || (is_thin(i) == is_thin(at) && d[i] > d[at])) at = i;
  }
  if (is_thin(at)) feature = t[at];
  defect.where = points[at] + domain.shift;
  defect.off_over_h = off_over_h;
  set_feature(feature, h_at[at], defect);
  return defect;
}

std::vector<MeshDefect> defects_of(const Domain& domain, const std::vector<Difference>& differences, const MeshEdge& h,
                                   const Context& context) {
  std::vector<Vec3> points;
  for (const Difference& d : differences) points.push_back(d.where);
  if (points.empty()) return {};
  const std::vector<double> h_at = h.at(points);
  const std::vector<double> feature = features(domain, points, h_at, context);
  std::vector<MeshDefect> defects;
  for (const DefectKind kind : {DefectKind::Folded, DefectKind::Off, DefectKind::Filled, DefectKind::Cut,
                                DefectKind::Thin, DefectKind::Topology, DefectKind::Missed, DefectKind::Edges}) {
    std::vector<std::size_t> of_kind;
    std::vector<Vec3> x;
    for (std::size_t i = 0; i < differences.size(); ++i) {
      if (differences[i].kind == kind) of_kind.push_back(i), x.push_back(points[i]);
    }
    for (const std::vector<int>& members : members_of(clusters(x, h.least()))) {
      MeshDefect defect;
      defect.kind = kind;
      defect.n = members.size();
      double least = kInfinity, farthest = -1, h_there = h.least();
      Box box;
      for (const int k : members) {
        const std::size_t i = of_kind[static_cast<std::size_t>(k)];
        least = std::min(least, feature[i]);
        box.extend(points[i]);
        if (differences[i].off <= farthest) continue;
        farthest = differences[i].off;
        h_there = h_at[i];
        defect.where = points[i] + domain.shift;
      }
      defect.off_over_h = farthest / h_there;
      defect.size_over_h = box.diagonal().norm() / h_there;
      set_feature(least, h_there, defect);
      defects.push_back(defect);
    }
  }
  return defects;
}

}  // namespace umtet
