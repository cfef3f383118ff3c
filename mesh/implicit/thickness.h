#pragma once

#include <limits>
#include <vector>

#include "common/context.h"
#include "mesh/core/implicit_function.h"

namespace umtet {

/// Distances from a point of the boundary, along the normal, to the sheet on the other side.
struct SheetDistances {
  double body, gap;  ///< through the body, and through the gap outside; model units
};

/// Parameters of the search along the normal; see thickness().
struct SheetSearch {
  double step, limit;  ///< model units
  double steepest = std::numeric_limits<double>::infinity();
  double growth = 0;  ///< least step, relative to the distance covered: a thinner wall may be stepped over
};

/// Both distances of x, a point of psi = 0 with unit normal n.
SheetDistances sheet_distances_from(ImplicitFunctionRef psi, const Vec3& x, const Vec3& n, const SheetSearch& search);

/// Both distances of each point. See thickness() for parameters, cost, and points without a sheet.
std::vector<SheetDistances> sheet_distances(ImplicitFunctionRef psi, const std::vector<Vec3>& points, double step,
                                            double limit, const Context& context = {},
                                            double steepest = std::numeric_limits<double>::infinity());

/// Both distances of each point, with an individual step and limit: `step` and `limit` times its scale, a length in
/// model units.
std::vector<SheetDistances> sheet_distances(ImplicitFunctionRef psi, const std::vector<Vec3>& points,
                                            const std::vector<double>& scale, double step, double limit,
                                            const Context& context = {},
                                            double steepest = std::numeric_limits<double>::infinity());

/// Local thickness: distance from each point of the boundary, along the normal, to the sheet on the other side of the
/// body or of the gap outside, whichever is closer. Where it is less than about two background edges, the body cannot
/// be meshed well.
///
/// Each x is first moved onto {psi = 0} along grad psi. Then psi is followed along -n and +n until its sign returns,
/// starting at step / 2, or closer if the other sheet is nearer.
/// @param points  near the boundary, within `step` or so (samples of it)
/// @param step    step length along the normal, model units: a wall or gap behind the first one may be stepped over if
///                it is thinner; > 0
/// @param limit   maximum search distance, model units; farther sheets count as `limit`
/// @return one distance per point; `limit` if grad psi vanishes or the point does not reach the boundary
/// @param steepest  an upper bound of |grad psi|, which permits longer steps where psi is far from zero
/// Cost: up to 2 limit / step values of psi per point; with a bound, about log(limit / step) steepest. Uses threads
/// over points; the result does not depend on them. \throw Cancelled
std::vector<double> thickness(ImplicitFunctionRef psi, const std::vector<Vec3>& points, double step, double limit,
                              const Context& context = {}, double steepest = std::numeric_limits<double>::infinity());

/// The same thickness, with an individual step and limit for each point, as for sheet_distances().
std::vector<double> thickness(ImplicitFunctionRef psi, const std::vector<Vec3>& points,
                              const std::vector<double>& scale, double step, double limit, const Context& context = {},
                              double steepest = std::numeric_limits<double>::infinity());

}  // namespace umtet
