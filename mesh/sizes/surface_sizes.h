#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "common/context.h"
#include "mesh/core/implicit_function.h"
#include "mesh/sizes/source_tree.h"

namespace umtet {

/// Parameters of the edge length on psi = 0; lengths in model units.
struct SurfaceSizeParams {
  double h;           ///< maximum
  double h_min;       ///< minimum
  double grade = .3;  ///< grade of the field that the sources are for
  /// Number of edges across the body, and across a gap outside; 0: thickness does not count.
  double edges_across = 2.2;
  double max_turn = 2 / 2.2;  ///< angle between the normals at the ends of an edge, radians; 0: no limit
  /// Lower limit, relative to h, of the edge length by max_turn alone: at a sharp edge the normal turns at any edge
  /// length, and on scans shorter edges mostly follow texture.
  double least_by_turn = .5;
  /// An edge may exceed max_turn where psi = 0 is within this distance, turn h / 8, of its midpoint: the noise of
  /// samples also turns the normal.
  double noise = 0;
  /// Largest distance of flat faces from psi = 0, by its curvature; 0: no limit. Requires Hessians.
  double deviation = 0;
  /// Returns whether the sheet of psi = 0 at x, where psi has this gradient, is known. Thickness counts only between
  /// two known sheets. Called by several threads. Empty: all sheets are known.
  std::function<bool(const Vec3& x, const Vec3& gradient)> is_known;
  double constant_layer = 2;                                  ///< radius of the sources, in multiples of their h
  double steepest = std::numeric_limits<double>::infinity();  ///< an upper bound of |grad psi|
};

/// Returns all broken constraints.
std::vector<std::string> problems(const SurfaceSizeParams&);

/// Size sources on psi = 0. The size of each is the least of
///
///     h,   t / edges_across,   max_turn / (turn of the normal a length),   sqrt(6.8 deviation / (|k1| + |k2|)),
///
/// with t the distance along the normal to the other side of the body or of the gap, but at least h_min. The default of
/// max_turn is the turn for a ball or a rod with 2.2 edges across it: h = 2 R / 2.2.
///
/// Where points are farther apart than the sources require, points are inserted at half the distance in the tangent
/// plane, until no gap is left. psi is therefore evaluated as finely as it will be meshed, and nowhere else. The radius
/// of the sources covers the space between them.
///
/// @param points   on psi = 0, or within `spacing` of it; they cover the whole surface, at most `spacing` apart. Points
///                 from which psi = 0 is not reached are dropped
/// @param enough   called with the present sources before more points are inserted than there have been so far; if it
///                 returns true, these sources are returned. May be empty
/// Cost: about forty values of psi per point. Uses threads over points; the result does not depend on them.
/// \throw std::invalid_argument for problems(), or a spacing that is not > 0; Cancelled
std::vector<SizeSource> surface_sizes(ImplicitFunctionRef psi, const std::vector<Vec3>& points, double spacing,
                                      const SurfaceSizeParams& params, const Context& context = {},
                                      const std::function<bool(const std::vector<SizeSource>&)>& enough = {});

}  // namespace umtet
