#include "mesh/certify/surface_measures.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh/implicit/foot_point.h"

namespace umtet {
namespace {

// The volume between a flat face and a quadric through its corners is this times area x distance of the centroid.
constexpr double kMeanOverCentroid = .75;

}  // namespace

double vertex_distance(ImplicitFunctionRef psi, const Vec3& x) {
  Vec3 g;
  const double value = psi.value(x, g);
  const double d = value == 0 ? 0 : std::abs(value) / g.norm();
  return std::isnan(d) ? std::numeric_limits<double>::infinity() : d;
}

FaceMeasure measure_face(ImplicitFunctionRef psi, const Vec3& a, const Vec3& b, const Vec3& c, double h) {
  const Vec3 centroid = (a + b + c) / 3.0;
  const Foot foot = foot_point(psi, centroid, h);
  const Vec3 n = (b - a).cross(c - a);
  const double length = n.norm();
  const double cosine = length > 0 ? n.dot(foot.normal) / length : -1.0;  // no area: no normal
  return {foot.found, foot.distance, cosine, length / 2, centroid, foot.point};
}

void add_gap(const FaceMeasure& face, double& gap) { gap += kMeanOverCentroid * face.area * face.distance; }

void begin_distances(MeshCertificate::Boundary& boundary) {
  boundary.max_vertex_distance_over_h = 0;
  boundary.max_centroid_distance_over_h = 0;
  boundary.max_centroid_distance = 0;
  boundary.min_cos_normal = 1;
  boundary.n_cos_below_half = boundary.n_unprojected_faces = 0;
  boundary.faults.clear();
  boundary.far_feet.clear();
}

void add_vertex(const Vec3& x, double distance, double h, double rounding, MeshCertificate::Boundary& boundary) {
  double& most = *boundary.max_vertex_distance_over_h;
  most = std::max(most, distance / h);
  if (distance / h <= vertex_tolerance(rounding, h)) return;
  boundary.faults.push_back({BoundaryFault::Kind::Off, x, distance});
}

void add_face(const FaceMeasure& f, double h, MeshCertificate::Boundary& boundary) {
  if (!f.found) {
    ++boundary.n_unprojected_faces;
    boundary.faults.push_back({BoundaryFault::Kind::Off, f.centroid, h});
    return;
  }
  double &most_over_h = *boundary.max_centroid_distance_over_h, &least_cos = *boundary.min_cos_normal;
  most_over_h = std::max(most_over_h, f.distance / h);
  boundary.max_centroid_distance = std::max(boundary.max_centroid_distance, f.distance);
  least_cos = std::min(least_cos, f.cos_normal);
  boundary.n_cos_below_half += f.cos_normal < 0.5;
  if (f.distance > kFarFace * h) boundary.far_feet.push_back(f.foot);
  if (!(f.cos_normal > 0)) boundary.faults.push_back({BoundaryFault::Kind::Folded, f.centroid, f.distance});
}

}  // namespace umtet
