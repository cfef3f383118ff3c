#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "common/context.h"
#include "mesh/core/implicit_function.h"
#include "mesh/sizes/source_tree.h"

namespace umtet {

/// What decides the edge length on psi = 0; lengths in model units.
struct SurfaceSizeParams {
  double h;           ///< the most
  double h_min;       ///< the least
  double grade = .3;  ///< of the field that the sources are for
  /// Edges across the body, and across a gap outside; 0: thickness does not count.
  double edges_across = 2.2;
  double max_turn = 2 / 2.2;  ///< angle between the normals at the ends of an edge, radians; 0: any
  /// By its turn alone no edge is shorter than this share of h: a sharp edge turns at once, whatever the edge length.
  double least_by_turn = .25;
  /// An edge may turn by more where psi = 0 is no farther from its middle than this, turn h / 8: the noise of samples
  /// turns, too.
  double noise = 0;
  double deviation = 0;       ///< of flat faces from psi = 0, by its curvature; 0: any. Needs Hessians
  double constant_layer = 2;  ///< radius of the sources, in their h
  double steepest = std::numeric_limits<double>::infinity();  ///< a bound of |grad psi|
};

/// Every broken constraint.
std::vector<std::string> problems(const SurfaceSizeParams&);

/// Sources on psi = 0, each with the least of
///
///     h,   t / edges_across,   max_turn / (turn of the normal a length),   sqrt(6.8 deviation / (|k1| + |k2|)),
///
/// t the distance along the normal to the other side of the body or of the gap, and not less than h_min. The default
/// of max_turn is that of a ball or a rod with 2.2 edges across it: h = 2 R / 2.2.
///
/// Points that are farther apart than all sources together ask for get others between them, at half the distance in
/// the tangent plane, until none are: psi is looked at as finely as it is going to be meshed, and nowhere else. The
/// radius of the sources covers what is between them.
///
/// @param points   of psi = 0, or within `spacing` of it: on all of the surface, no farther apart than `spacing`. Those
///                 that do not reach it are left out
/// @param enough   asked before more points are put between others than there have been so far, with their sources:
///                 true ends it with these. May be empty
/// Cost: some forty values of psi a point. Threads over points; the result does not depend on them.
/// \throw std::invalid_argument  problems(), or a spacing that is not > 0; Cancelled
std::vector<SizeSource> surface_sizes(ImplicitFunctionRef psi, const std::vector<Vec3>& points, double spacing,
                                      const SurfaceSizeParams& params, const Context& context = {},
                                      const std::function<bool(const std::vector<SizeSource>&)>& enough = {});

}  // namespace umtet
