#pragma once

#include <limits>
#include <vector>

#include "common/context.h"
#include "mesh/core/implicit_function.h"

namespace umtet {

/// How far it is from a point of the boundary, along the normal, to the sheet on the other side.
struct SheetDistances {
  double body, gap;  ///< through the body, and through the gap outside; model units
};

/// How psi is followed along the normal; see thickness().
struct SheetSearch {
  double step, limit;  ///< model units
  double steepest = std::numeric_limits<double>::infinity();
  double growth = 0;  ///< steps are at least this share of the way so far: a wall may be stepped over that is thinner
};

/// Both distances of x, a point of psi = 0 with the unit normal n.
SheetDistances sheet_distances_from(ImplicitFunctionRef psi, const Vec3& x, const Vec3& n, const SheetSearch& search);

/// Both distances of each point; see thickness() for the parameters, the cost and the points that have none.
std::vector<SheetDistances> sheet_distances(ImplicitFunctionRef psi, const std::vector<Vec3>& points, double step,
                                            double limit, const Context& context = {},
                                            double steepest = std::numeric_limits<double>::infinity());

/// The same, with a step and a limit for each point: `step` and `limit` times its scale, a length in model units.
std::vector<SheetDistances> sheet_distances(ImplicitFunctionRef psi, const std::vector<Vec3>& points,
                                            const std::vector<double>& scale, double step, double limit,
                                            const Context& context = {},
                                            double steepest = std::numeric_limits<double>::infinity());

/// How far it is from each point of the boundary, along the normal, to the sheet on the other side: through the body,
/// or through the gap outside, whichever is shorter. What is thinner than about two background edges cannot be meshed
/// well.
///
/// Each x is first moved onto {psi = 0} along grad psi; then psi is followed along -n and +n until its sign returns,
/// from step / 2 on, or from less where the other sheet is nearer.
/// @param points  near the boundary, within `step` or so (samples of it)
/// @param step    how finely psi is followed, model units: a wall or gap behind the first, thinner than this, may be
///                stepped over; > 0
/// @param limit   distances are looked for up to here, model units; farther sheets count as `limit`
/// @return one distance per point; `limit` where grad psi vanishes or the point does not reach the boundary
/// @param steepest  a bound of |grad psi|: steps are as long as it allows where psi is far from zero
/// Cost: up to 2 limit / step values of psi a point; with a bound, about log(limit / step) steepest. Threads over
/// points; the result does not depend on them. \throw Cancelled
std::vector<double> thickness(ImplicitFunctionRef psi, const std::vector<Vec3>& points, double step, double limit,
                              const Context& context = {}, double steepest = std::numeric_limits<double>::infinity());

/// The same, with a step and a limit for each point, as above.
std::vector<double> thickness(ImplicitFunctionRef psi, const std::vector<Vec3>& points,
                              const std::vector<double>& scale, double step, double limit, const Context& context = {},
                              double steepest = std::numeric_limits<double>::infinity());

}  // namespace umtet
