#pragma once

#include <vector>

#include "body/body.h"
#include "body/fidelity/lost_surface.h"
#include "body/fidelity/mesh_edge.h"
#include "common/context.h"
#include "mesh/implicit/surface_distance.h"

namespace umtet {

/// Finds parts of psi = 0 that continue beyond the boundary of a mesh: the end of a blade, a spike or a wire that is
/// too thin to contain background vertices, or a sharp edge. A grid misses some of them, but they all begin where the
/// mesh ends; there the mesh is thin, or cuts the edge off.
///
/// From each start, eight walks follow psi = 0 in steps of h / 4, shorter at the end, while their distance from the
/// boundary increases. At each step a walk turns towards increasing distance.
/// @param starts  points of psi = 0 on the boundary or near it: vertices where the body or a gap is thinner than
///                kLeastEdgesAcross h, and MeshCertificate::Boundary::far_feet
/// @param h       edge length; the value at a start applies to all its walks
/// @param beyond  distance in h
/// @return the points of the walks that are farther than `beyond` from the boundary
/// Cost: eight steps per start if nothing is lost. The result does not depend on the number of threads.
/// \throw Cancelled
std::vector<LostPoint> lost_ends(const Domain& domain, const std::vector<Vec3>& starts, const SurfaceDistance& boundary,
                                 const MeshEdge& h, double beyond, const Context& context = {});

}  // namespace umtet
