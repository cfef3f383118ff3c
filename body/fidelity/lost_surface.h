#pragma once

#include <vector>

#include "body/body.h"
#include "body/fidelity/mesh_edge.h"
#include "common/context.h"
#include "mesh/implicit/surface_distance.h"

namespace umtet {

/// A point of psi = 0, and how far it is from the boundary of a mesh, model units.
struct LostPoint {
  Vec3 where;
  double distance;
};

/// Follows psi = 0 from points that a mesh has lost to all that it has lost there [Bloomenthal1988]: a plate much
/// thinner than h has points of a grid in it here and there only.
///
/// From each point eight steps of h / 2 go along psi = 0. Where one leads into a cube of edge h / 2 without a point,
/// and farther than `beyond` from the boundary, it goes on from there.
/// @param seeds   farther than `beyond` from the boundary
/// @param beyond  in h
/// @return the seeds and then the others
/// Cost: at most eight foot points for each cube that the lost surface meets. The result does not depend on the number
/// of threads. \throw Cancelled
std::vector<LostPoint> lost_surface(const Domain& domain, std::vector<LostPoint> seeds, const SurfaceDistance& boundary,
                                    const MeshEdge& h, double beyond, const Context& context = {});

}  // namespace umtet
