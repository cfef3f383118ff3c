#pragma once

#include <optional>

#include "common/vec3.h"
#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

/// A plane, sphere, cylinder or cone as the zero set of its signed distance f, negative inside of the body:
///
///     plane     f = n . x - d
///     sphere    f = +-(|x - c| - R)
///     cylinder  f = +-(r - R),                           r = distance from the axis
///     cone      f = +-(r cos(alpha) - z sin(alpha)),     z = height over the apex, alpha = half the opening angle
class PatchPrimitive {
 public:
  enum class Kind { Plane, Sphere, Cylinder, Cone };

  Kind kind = Kind::Plane;
  double side = 1;              ///< 1 if f grows away from the centre or axis, -1 for a hole
  Vec3 point = Vec3::Zero();    ///< point of the plane or the axis, the centre, or the apex
  Vec3 axis = Vec3::Zero();     ///< unit vector: the normal n, or the axis, of a cone from the apex into the cone
  double radius = 0;            ///< model units
  double sine = 0, cosine = 1;  ///< sine and cosine of alpha

  /// f(x). Gradient and Hessian are written to pointers that are not null. At the centre, the axis and beyond the apex
  /// f has no gradient; it is zero there.
  double evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const;
};

/// Tolerances of fit_primitive(), model units.
struct PrimitiveTolerances {
  double vertex;  ///< largest distance of a vertex from the surface
  double facet;   ///< largest distance of the middle of a triangle or of a side from it
};

/// The plane, sphere, cylinder or cone, in this order, on which some triangles lie: their vertices within a tolerance,
/// and their middles, which are on chords, within another.
///
/// The axis a of cylinders and cones is the direction for which n . a varies least over the normals, by area. The
/// circle of a cylinder and the sphere are least-squares fits to the vertices [Kasa1976]; the apex of a cone is the
/// point nearest to the planes of all triangles.
/// @return none if there is no such surface, or if the apex of the cone is a vertex
std::optional<PatchPrimitive> fit_primitive(const TriangleMesh& patch, const PrimitiveTolerances& tolerances);

}  // namespace umtet
