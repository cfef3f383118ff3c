#pragma once

#include <optional>
#include <vector>

#include "body/body.h"
#include "body/fidelity/mesh_defects.h"
#include "body/fidelity/mesh_measures.h"
#include "body/fidelity/mesh_thickness.h"
#include "body/pieces/zero_set_choice.h"
#include "common/context.h"
#include "mesh/certify/certificate.h"
#include "mesh/features/piecewise_mesh.h"
#include "mesh/implicit/surface_distance.h"
#include "mesh/sizes/size_field.h"

namespace umtet {

/// The pieces and handles of psi = 0 and of the boundary, and the place where they differ, if they do.
struct ZeroSetComparison {
  ZeroSetReport report;
  std::optional<MeshDefect> defect;
};

/// Input of compare_with_domain() besides the mesh and the pieces.
struct ComparisonParams {
  const PointThickness& thickness;
  const SurfaceDistance* surface;  ///< null: the mesh has no boundary
  const MeshEdge& h;
  const SizeField* sizes;         ///< the sizes of a graded mesh, or null
  const PiecewiseMesh* features;  ///< the mesh with its sharp edges, or null
};

/// Compares the topology of the boundary with the pieces of psi = 0 that are kept, and with the walls of the box around
/// a fluid, one closed piece without a hole.
///
/// Where the two counts differ, psi = 0 is counted again on edges half as long, if the finer grid is not too large. A
/// count on a grid that is coarser than the mesh says nothing against the mesh. Equal counts prove nothing where the
/// body or a gap is thinner than an edge of the count. For a body with acute edges, a count says nothing against a mesh
/// that passes near every point of psi = 0.
///
/// The report also contains the proof that the count has missed no piece of a level set, and the support of the
/// boundary by samples.
/// @param faces  boundary faces on psi = 0
/// \throw Cancelled
ZeroSetComparison compare_with_domain(const Domain& domain, const TetMesh& mesh, const std::vector<Triangle>& faces,
                                      const MeshCertificate& certificate, const ZeroSetChoice& pieces,
                                      const ComparisonParams& params, const Context& context);

}  // namespace umtet
