#pragma once

#include <vector>

#include "body/body.h"
#include "common/context.h"
#include "mesh/implicit/thickness.h"

namespace umtet {

/// sheet_distances() of the body of a domain, without the wedges at its sharp edges: there the sheet on the other side
/// is arbitrarily near and no thin part. In a wedge the two sheets belong to different patches, and their normals are
/// more than 20 degrees from opposite.
/// @param scale        length for each point, model units
/// @param step, limit  as for sheet_distances(), in this length
/// \throw Cancelled
std::vector<SheetDistances> body_sheets(const Domain& domain, const std::vector<Vec3>& points,
                                        const std::vector<double>& scale, double step, double limit,
                                        const Context& context = {});

/// The least of both distances for each point.
std::vector<double> body_thickness(const Domain& domain, const std::vector<Vec3>& points,
                                   const std::vector<double>& scale, double step, double limit,
                                   const Context& context = {});

}  // namespace umtet
