#pragma once

#include <vector>

#include "body/body.h"
#include "body/fidelity/mesh_defect.h"
#include "body/fidelity/mesh_edge.h"
#include "body/pieces/zero_set_choice.h"
#include "mesh/certify/certificate.h"
#include "mesh/implicit/surface_distance.h"
#include "mesh/submesh/um_result.h"

// Where a mesh is not what psi = 0 is. All coordinates are working coordinates, but for those of MeshDefect.
namespace umtet {

/// A point of psi = 0 or of the boundary of a mesh, where the two differ.
struct Difference {
  DefectKind kind;
  Vec3 where;
  double off;  ///< how far it is from the other one, model units
};

/// Faces that are folded, vertices and faces that are off.
std::vector<Difference> differences_of(const MeshCertificate& certificate);

/// Points of psi = 0 farther than kSmallOff h from the boundary of the mesh: body or gap thinner than an edge can be
/// skipped without a trace in topology or normals. Those of a grid and of lost_ends(), and lost_surface() from there
/// on.
/// @param psi_points, starts  see there \throw Cancelled
std::vector<Difference> lost_parts(const Domain& domain, const std::vector<Vec3>& psi_points,
                                   const std::vector<Vec3>& starts, const SurfaceDistance& boundary, const MeshEdge& h,
                                   const Context& context = {});

/// Vertices of the background that changed sides for a manifold boundary and left a trace: psi = 0 within an edge of
/// them is farther from the boundary of the mesh than flat faces explain where it is as sharply curved as h can just
/// show. Elsewhere projection has brought the boundary to psi = 0 all the same.
/// @param psi_points  of psi = 0, about an edge apart or less \throw Cancelled
std::vector<Difference> flips_that_show(const std::vector<ManifoldFlip>& flips, const std::vector<Vec3>& psi_points,
                                        const SurfaceDistance& boundary, const MeshEdge& h,
                                        const Context& context = {});

/// Where to look when psi = 0 and the boundary of a mesh are not alike: at the thin point of psi = 0 that is farthest
/// from it. What has come or gone is no larger than the largest of such distances, which is `off`. Without a thin point
/// there is no feature to explain it, and the place is the farthest point of all.
/// @param counted  the pieces of psi = 0 as they were counted, at a spacing <= h
/// @param n        by how many pieces and handles the two differ \throw Cancelled
MeshDefect topology_defect(const Domain& domain, const ZeroSetChoice& counted, const SurfaceDistance& boundary,
                           const MeshEdge& h, std::size_t n, const Context& context = {});

/// Differences of a kind that are within an edge or two of each other are one place.
///
/// Cost: some twenty values of psi a difference. The result does not depend on the number of threads. \throw Cancelled
std::vector<MeshDefect> defects_of(const Domain& domain, const std::vector<Difference>& differences, const MeshEdge& h,
                                   const Context& context = {});

}  // namespace umtet
