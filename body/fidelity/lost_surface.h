#pragma once

#include <vector>

#include "body/body.h"
#include "body/fidelity/mesh_edge.h"
#include "common/context.h"
#include "mesh/implicit/surface_distance.h"

namespace umtet {

/// A point of psi = 0, and its distance from the boundary of a mesh, model units.
struct LostPoint {
  Vec3 where;
  double distance;
};

/// Finds the complete part of psi = 0 that a mesh has lost, from some of its points, by following psi = 0
/// [Bloomenthal1988]: a plate much thinner than h contains only a few points of a grid.
///
/// From each point, eight steps of h / 2 follow psi = 0. A step that ends in a cube of edge h / 2 without a point, and
/// farther than `beyond` from the boundary, adds a point.
/// @param seeds   points farther than `beyond` from the boundary
/// @param beyond  distance in h
/// @return the seeds, followed by the other points
/// Cost: at most eight foot points for each cube that the lost surface meets. The result does not depend on the number
/// of threads. \throw Cancelled
std::vector<LostPoint> lost_surface(const Domain& domain, std::vector<LostPoint> seeds, const SurfaceDistance& boundary,
                                    const MeshEdge& h, double beyond, const Context& context = {});

}  // namespace umtet
