#pragma once

#include <vector>

#include "body/body.h"
#include "body/fidelity/mesh_defect.h"
#include "body/fidelity/mesh_edge.h"
#include "body/pieces/zero_set_choice.h"
#include "mesh/certify/certificate.h"
#include "mesh/implicit/surface_distance.h"
#include "mesh/submesh/um_result.h"

// Differences between a mesh and psi = 0. All coordinates are working coordinates, except in MeshDefect.
namespace umtet {

/// A point of psi = 0 or of the boundary of a mesh, where the two differ.
struct Difference {
  DefectKind kind;
  Vec3 where;
  double off;  ///< distance from the other surface, model units
};

/// Returns the folded faces, and the vertices and faces that are not on psi = 0.
std::vector<Difference> differences_of(const MeshCertificate& certificate);

/// Returns points of psi = 0 that are farther than kSmallOff h from the boundary of the mesh. A mesh can omit a body or
/// a gap that is thinner than an edge without a trace in topology or normals. The points come from a grid and from
/// lost_ends(), and from lost_surface() with these as seeds.
/// @param psi_points  points of psi = 0 on a grid
/// @param starts      as for lost_ends()
/// \throw Cancelled
std::vector<Difference> lost_parts(const Domain& domain, const std::vector<Vec3>& psi_points,
                                   const std::vector<Vec3>& starts, const SurfaceDistance& boundary, const MeshEdge& h,
                                   const Context& context = {});

/// Returns the background vertices that changed sides for a manifold boundary, if the change is visible: within an edge
/// length, psi = 0 is farther from the boundary of the mesh than flat faces explain, even for the largest curvature
/// that h resolves. Otherwise projection has moved the boundary onto psi = 0 despite the change.
/// @param psi_points  points of psi = 0, at most about an edge length apart
/// \throw Cancelled
std::vector<Difference> flips_that_show(const std::vector<ManifoldFlip>& flips, const std::vector<Vec3>& psi_points,
                                        const SurfaceDistance& boundary, const MeshEdge& h,
                                        const Context& context = {});

/// Locates a difference in topology between psi = 0 and the boundary of a mesh. The position is the thin point of psi =
/// 0 that is farthest from the boundary. The part that appeared or disappeared is not larger than this distance, which
/// is `off`. If there is no thin point, no feature explains the difference, and the position is the farthest of all
/// points.
/// @param counted  the pieces of psi = 0, counted with a spacing <= h
/// @param n        difference in the number of pieces and handles
/// \throw Cancelled
MeshDefect topology_defect(const Domain& domain, const ZeroSetChoice& counted, const SurfaceDistance& boundary,
                           const MeshEdge& h, std::size_t n, const Context& context = {});

/// Combines differences into defects: differences of one kind that are within one or two edge lengths of each other
/// form one defect.
///
/// Cost: about twenty values of psi per difference. The result does not depend on the number of threads. \throw
/// Cancelled
std::vector<MeshDefect> defects_of(const Domain& domain, const std::vector<Difference>& differences, const MeshEdge& h,
                                   const Context& context = {});

}  // namespace umtet
