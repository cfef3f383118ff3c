#pragma once

#include <vector>

#include "body/body.h"
#include "body/fidelity/lost_surface.h"
#include "body/fidelity/mesh_edge.h"
#include "common/context.h"
#include "mesh/implicit/surface_distance.h"

namespace umtet {

/// Where psi = 0 goes on beyond the boundary of a mesh: the end of a blade, a spike or a wire that is too thin to have
/// vertices of the background inside, or a sharp edge. No grid sees all of them, but they begin where the mesh ends;
/// there it is thin, or cuts the edge off.
///
/// From each start eight walks go along psi = 0, in steps of h / 4 and, at the end, shorter ones, as long as they lead
/// away from the boundary. At each step they turn to where it is farther.
/// @param starts  points of psi = 0 on the boundary or near it: vertices where body or gap are thinner than
///                kLeastEdgesAcross h, MeshCertificate::Boundary::far_feet
/// @param h       that of a start serves all its walks
/// @param beyond  in h
/// @return the points of the walks that are farther than `beyond` from the boundary
/// Cost: eight steps a start where nothing is lost. The result does not depend on the number of threads.
/// \throw Cancelled
std::vector<LostPoint> lost_ends(const Domain& domain, const std::vector<Vec3>& starts, const SurfaceDistance& boundary,
                                 const MeshEdge& h, double beyond, const Context& context = {});

}  // namespace umtet
