#pragma once

#include "mesh/certify/certificate.h"
#include "mesh/core/implicit_function.h"

// Measures of a certificate that compare a boundary with psi = 0, by vertex and by face.
namespace umtet {

/// |psi| / |grad psi| at x; infinite where it is not a number.
double vertex_distance(ImplicitFunctionRef psi, const Vec3& x);

/// Position of a face relative to psi = 0.
struct FaceMeasure {
  bool found;       ///< there is a point of psi = 0 near the centroid
  double distance;  ///< distance between this point and the centroid, model units
  double cos_normal, area;
  Vec3 centroid, foot;
};
/// Measures a face. @param h  see foot_point()
FaceMeasure measure_face(ImplicitFunctionRef psi, const Vec3& a, const Vec3& b, const Vec3& c, double h);

/// Adds the volume between the face and psi = 0. \pre found
void add_gap(const FaceMeasure& face, double& gap);

/// Initialises extrema, counts and lists to those of an empty boundary, except for the gap.
void begin_distances(MeshCertificate::Boundary& boundary);
/// Adds a boundary vertex.
/// @param distance  vertex_distance()
/// @param rounding  MeshCertificate::coordinate_rounding
void add_vertex(const Vec3& x, double distance, double h, double rounding, MeshCertificate::Boundary& boundary);
/// Adds a boundary face, except for its gap.
void add_face(const FaceMeasure& face, double h, MeshCertificate::Boundary& boundary);

/// Maximum distance of a vertex from psi = 0, in h.
inline double vertex_tolerance(double rounding, double h) { return kVertexTolerance + rounding / h; }

}  // namespace umtet
