#pragma once

#include "body/body.h"
#include "common/context.h"
#include "mesh/implicit/closest_point.h"
#include "mesh/universal_mesh.h"

namespace umtet {

/// Shifts the level of psi until a mesh has the volume of the triangles, and moves its boundary onto the new psi = 0.
///
/// psi rounds edges, and flat faces cut corners: a bar of four edges a side loses some per cent. The shift e of the
/// level solves V(e) = V of the triangles by Newton's method, V' = area, in three rounds at most. Nothing happens where
/// the two differ by less than a thousandth or where triangles bound no closed body. What has been done is taken back
/// where e would be more than a tenth of h, a vertex finds no point of psi = 0, or a tet would lose half its mean
/// ratio.
///
/// @param h        edge length for which psi is cut
/// @param result   `final` moves. Vertices that are not on psi = 0 stay where they are.
/// @return whether it has the volume of the triangles within a thousandth; false, too, where that has no meaning
bool match_volume(Domain& domain, double h, const ClosestPointParams& params, UmResult& result,
                  const Context& context = {});

}  // namespace umtet
