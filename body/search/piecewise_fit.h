#pragma once

#include <memory>

#include "body/options.h"
#include "body/piecewise_body.h"
#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/features/piecewise_mesh.h"
#include "mesh/submesh/chosen_submesh.h"
#include "mesh/submesh/um_result.h"

namespace umtet {

/// \throw UsageError  an option that meshes of bodies with sharp edges do not have: a background of the caller,
///                    walls, Algorithm 1 of the paper, or curved edges
void require_piecewise(const BodyOptions& options);

/// The parameters of make_piecewise_mesh() for these options.
PiecewiseMeshParams piecewise_params(const MeshOptions& options);

/// A mesh of a piecewise smooth body in the form of universal_mesh(), and its curves and patches.
struct PiecewiseFit {
  UmResult result;
  std::shared_ptr<PiecewiseMesh> features;  ///< mesh with the vertices and faces of the result, which contains its tets
};

/// fit_piecewise_mesh() of the body.
/// @param within_reach  mean ratio that tets of this body can reach: flips leave tets that are better
/// \throw Cancelled
PiecewiseFit fit_piecewise(const PiecewiseBody& body, const BackgroundMesh& background, ChosenSubmesh chosen,
                           const MeshOptions& options, double within_reach, const Context& context = {});

}  // namespace umtet
