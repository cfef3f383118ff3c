#pragma once

#include "body/body.h"
#include "common/context.h"
#include "mesh/implicit/closest_point.h"
#include "mesh/universal_mesh.h"

namespace umtet {

/// Shifts the level of psi until the mesh has the volume that the triangles enclose, and moves the boundary of the mesh
/// onto the new psi = 0.
///
/// psi rounds edges, and flat faces cut corners: a bar four edges wide loses a few per cent of its volume. The shift e
/// of the level is the solution of V(e) = V(triangles) by Newton's method with V' = area, in at most three iterations.
/// The function does nothing if the volumes differ by less than a thousandth, or if the triangles do not bound a closed
/// body. It undoes all changes if e exceeds a tenth of h, if the projection of a vertex onto psi = 0 fails, or if a tet
/// would lose half of its mean ratio.
///
/// @param h        edge length of the mesh, which determines the detail of psi (Domain::limit_detail())
/// @param result   the vertices in `final` move. Vertices that are not on psi = 0 keep their positions.
/// @return true if the volumes agree within a thousandth; false also if there are no triangles that bound a closed body
bool match_volume(Domain& domain, double h, const ClosestPointParams& params, UmResult& result,
                  const Context& context = {});

}  // namespace umtet
