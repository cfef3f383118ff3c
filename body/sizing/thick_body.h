#pragma once

#include <memory>
#include <vector>

#include "body/body.h"
#include "body/options.h"
#include "common/context.h"
#include "mesh/core/implicit_function.h"
#include "mesh/sizes/body_size.h"

namespace umtet {

/// Returns whether a thickened body may be used to choose the vertices: the body of closed triangles, in fast mode,
/// without walls, in a background with one edge length.
bool may_be_thickened(const Domain& domain, const BodyOptions& options);

/// The thickness of a body of triangles and of the gaps outside it, at samples that represent equal areas.
struct TriangleThickness {
  std::vector<Vec3> points;  ///< samples on the triangles, working coordinates
  /// Distance from each sample to the sheet behind it, model units; infinite beyond the limit.
  std::vector<double> body;
  std::vector<double> gap;    ///< distance from each sample to the sheet in front of it
  double area_of_sample = 0;  ///< model units^2

  /// Returns the quantile `part` of the least thickness of body and gap at the samples; infinite if it exceeds the
  /// limit.
  double share(double part) const;
};

/// Measures thickness by rays (body_thickness.h) up to `limit`, model units.
/// \pre domain.triangles
/// \throw Cancelled
TriangleThickness triangle_thickness(const Domain& domain, double limit, const Context& context = {});

/// Returns the distance, model units, by which each side of a body moves outwards before the boundary vertices are
/// chosen: the thickness then is kEdgesAcross h.
double thickening(double thickness, double h);

/// Returns the volume of the thickened body and the area of the body, from which the number of tets is estimated.
BodySize thickened_size(const BodySize& size, const TriangleThickness& thickness, double h);

/// Returns the mean ratio that repair can reach where the body has this thickness: three quarters of the mean ratio of
/// a slab of regular tets, 2.2 edges thick, that is compressed to this thickness. It was measured on plates, tubes and
/// boxes of .5 to 1.3 h.
double quality_within_reach(double thickness, double h);

/// An implicit function, negative in a closed body that is thickened where it is thinner than 2.2 h, by up to 1.1 h on
/// each side: the signed distance to its triangles minus the thickening. If it classifies the vertices, there are two
/// layers of tets between two sheets at any distance; projection then compresses the tets. Thickening does not make a
/// gap outside thinner than 1.1 h.
///
/// The thickening at a point is the maximum, over the samples around it, of the thickening at the sample minus half the
/// distance of the sample, so it changes slowly. At distances beyond 3 h from the triangles the value is 3 h with the
/// sign of psi.
class ThickBody {
 public:
  /// @param domain     its triangles bound a closed body; it must outlive this object and must not move
  /// @param thickness  thickness, measured up to a limit of at least 2.2 h
  ThickBody(const Domain& domain, const TriangleThickness& thickness, double h);
  ~ThickBody();
  ThickBody(ThickBody&&) noexcept;

  /// Evaluates the function. The gradient ignores changes of the thickening: it is the unit gradient of the distance.
  /// The Hessian is zero.
  double evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const;
  double value(const Vec3& x) const { return evaluate(x, nullptr, nullptr); }

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

}  // namespace umtet
