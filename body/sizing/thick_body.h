#pragma once

#include <memory>
#include <vector>

#include "body/body.h"
#include "body/options.h"
#include "common/context.h"
#include "mesh/core/implicit_function.h"
#include "mesh/sizes/body_size.h"

namespace umtet {

/// Whether vertices may be chosen by a body that has been thickened: that of closed triangles, in fast mode, without
/// walls, in a background of one edge length.
bool may_be_thickened(const Domain& domain, const BodyOptions& options);

/// How thin the triangles of a body are, at samples that stand for equal areas of them.
struct TriangleThickness {
  std::vector<Vec3> points;   ///< on the triangles, working coordinates
  std::vector<double> body;   ///< to the sheet behind each, model units; infinite beyond the limit
  std::vector<double> gap;    ///< to the sheet before it
  double area_of_sample = 0;  ///< model units^2

  /// What this share of the samples is thinner than, body or gap; infinite where fewer are thin.
  double share(double part) const;
};

/// Measured by rays (body_thickness.h) up to `limit`. \pre domain.triangles \throw Cancelled
TriangleThickness triangle_thickness(const Domain& domain, double limit, const Context& context = {});

/// So thick, in h, a body is made before its boundary vertices are chosen: two edges and a fifth across, as everywhere
/// (kEdgesAcross).
double thickening(double thickness, double h);

/// Volume and area that the number of tets follows: of the body with what thickening adds to it.
BodySize thickened_size(const BodySize& size, const TriangleThickness& thickness, double h);

/// Least mean ratio that is worth repairing for where the body is `thickness` thick: of a slab of regular tets of 2.2
/// edges, pressed to that, three quarters; measured on plates, tubes and boxes of .5 to 1.3 h.
double quality_within_reach(double thickness, double h);

/// Negative in a body that is closed and has been thickened where it is thinner than 2.2 h, by up to 1.1 h on each
/// side: the signed distance to its triangles, less that thickening. Vertices that are chosen by it leave two layers of
/// tets between two sheets, however near these are; projection then presses the tets flat. Where a gap outside is thin,
/// its walls do not come nearer to each other than 1.1 h by this.
///
/// The thickening of a place is the greatest of the samples around, less half their distance, so that it changes
/// slowly. Beyond three h from the triangles the value is 3 h, with the sign of psi.
class ThickBody {
 public:
  /// @param domain     stays where it is; \\pre its triangles bound a closed body
  /// @param thickness  up to 2.2 h and more
  ThickBody(const Domain& domain, const TriangleThickness& thickness, double h);
  ~ThickBody();
  ThickBody(ThickBody&&) noexcept;

  /// The gradient is that of the distance alone, unit; the Hessian that of a plane, zero.
  double evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const;
  double value(const Vec3& x) const { return evaluate(x, nullptr, nullptr); }

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

}  // namespace umtet
