#pragma once

#include <vector>

#include "body/body.h"
#include "body/fidelity/mesh_edge.h"
#include "body/fidelity/mesh_measures.h"
#include "common/context.h"
#include "mesh/features/piecewise_mesh.h"
#include "mesh/implicit/surface_distance.h"

namespace umtet {

/// The part of a certificate about the sharp edges of a mesh of domain.piecewise.
/// @param mesh  its vertices and its faces; tets are not used
FeatureReport feature_report(const PiecewiseDomain& body, const PiecewiseMesh& mesh);

/// The sharp edges and corners that the mesh does not have: one defect for each curve, with the length of its box, and
/// for each corner and each place without a curve where patches touch.
/// @param boundary  distance to the faces of the mesh
/// \pre domain.piecewise \throw Cancelled
std::vector<MeshDefect> missed_features(const Domain& domain, const PiecewiseMesh& mesh,
                                        const SurfaceDistance& boundary, const MeshEdge& h,
                                        const Context& context = {});

}  // namespace umtet
