#pragma once

#include "mesh/certify/certificate.h"
#include "mesh/core/implicit_function.h"

// What a certificate says of a boundary beside psi = 0, vertex by vertex and face by face.
namespace umtet {

/// |psi| / |grad psi| at x; infinite where that is not a number.
double vertex_distance(ImplicitFunctionRef psi, const Vec3& x);

/// How a face lies beside psi = 0.
struct FaceMeasure {
  bool found;       ///< there is a point of psi = 0 near the centroid
  double distance;  ///< from there to the centroid, model units
  double cos_normal, area;
  Vec3 centroid, foot;
};
/// @param h  see foot_point()
FaceMeasure measure_face(ImplicitFunctionRef psi, const Vec3& a, const Vec3& b, const Vec3& c, double h);

/// Adds the volume between the face and psi = 0. \pre found
void add_gap(const FaceMeasure& face, double& gap);

/// Nothing has been measured yet: extremes, counts and lists are those of no vertex and no face. The gap is left out.
void begin_distances(MeshCertificate::Boundary& boundary);
/// @param distance  vertex_distance()
/// @param rounding  MeshCertificate::coordinate_rounding
void add_vertex(const Vec3& x, double distance, double h, double rounding, MeshCertificate::Boundary& boundary);
/// All but the gap.
void add_face(const FaceMeasure& face, double h, MeshCertificate::Boundary& boundary);

/// How far from psi = 0 a vertex may be, in h.
inline double vertex_tolerance(double rounding, double h) { return kVertexTolerance + rounding / h; }

}  // namespace umtet
