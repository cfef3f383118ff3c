#pragma once

#include <vector>

#include "body/body.h"
#include "body/piecewise_body.h"
#include "common/context.h"
#include "mesh/certify/certificate.h"
#include "mesh/core/piecewise_domain.h"
#include "mesh/core/tet_mesh.h"

namespace umtet {

/// The patch of each boundary face of a mesh whose file does not have it: all corners are within `tolerance` of the
/// patch and, where several are such, the normal of the face is nearest to that of the patch. If several
/// patches have the same normal, like two parts of a plane, the one that is active at the centroid is chosen. -1: none.
/// @param tolerance  model units
/// Cost: one value of each patch per vertex. \throw Cancelled
std::vector<int> patches_by_position(const PiecewiseDomain& body, const std::vector<Vec3>& V,
                                     const std::vector<Triangle>& faces, double tolerance, const Context& context = {});

/// The same for a mesh of domain.piecewise with edge length h, from its file. V are working coordinates.
std::vector<int> patches_by_position(const Domain& domain, const std::vector<Vec3>& V,
                                     const std::vector<Triangle>& faces, double h, const Context& context = {});

/// Fills the measures of a certificate that refer to psi: each face is measured against its own patch, and each vertex
/// against the patches of all its faces. psi as a whole is not differentiable at sharp edges, and the foot of a face on
/// it may lie on the patch beyond the edge.
/// @param patch        per face; -1: psi as a whole
/// @param certificate  of the same mesh, without psi
/// \throw Cancelled
void measure_against_patches(const PiecewiseBody& body, const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                             const std::vector<int>& patch, const Context& context, MeshCertificate& certificate);

}  // namespace umtet
