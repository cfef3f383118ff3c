#pragma once

#include <vector>

#include "body/body.h"
#include "body/fidelity/mesh_edge.h"
#include "body/fidelity/mesh_measures.h"
#include "body/pieces/zero_set_choice.h"
#include "body/sizing/too_thin.h"
#include "mesh/features/piecewise_mesh.h"
#include "mesh/sizes/size_field.h"
#include "mesh/universal_mesh.h"

namespace umtet {

/// Measurements of a mesh with flat faces, and all its defects.
struct Measurement {
  MeshMeasures measures;
  std::vector<MeshDefect> defects;  ///< all defects, in the order of measures.defects.listed
};

/// Optional data for measure().
struct MeasureParams {
  const ThinPlaces* thin = nullptr;  ///< thin places of the psi that was meshed; null if they were not searched
  /// Largest permitted distance of face centres from psi = 0, model units; 0: no limit.
  double max_deviation = 0;
  const SizeField* sizes = nullptr;  ///< the sizes for which a graded mesh was made
  /// Certificate of the whole mesh, if the result contains only its boundary; null: it is made from the result.
  const MeshCertificate* certificate = nullptr;
  /// The curves and patches of a mesh of Domain::piecewise, whose tets are those of the result; null for a smooth body.
  const PiecewiseMesh* features = nullptr;
};

/// certify() against psi of the domain. Faces of a piecewise smooth body are measured against their patches.
MeshCertificate certify_against(const Domain& domain, CertificateInput input);

/// Returns the edge length of a mesh. If the background is not a lattice, it varies: there is one value for each vertex
/// of the boundary.
/// @param h  edge length that was requested for the background
MeshEdge mesh_edge(const BackgroundMesh& background, const UmResult& result, double h);

/// Measures a mesh.
/// @param mesh    the tets of the result, with its final vertices
/// @param result  the result of the algorithm
/// @param h       edge length of the mesh
/// \throw Cancelled
Measurement measure(const Domain& domain, const TetMesh& mesh, const UmResult& result, const ZeroSetChoice& pieces,
                    const MeshEdge& h, const MeasureParams& params = {}, const Context& context = {});

/// Returns the measurements of a mesh that was not made by this library, from its certificate.
/// @param domain  domain of the psi that it was certified against; null if there was none
MeshMeasures measures_of(MeshCertificate certificate, const Domain* domain, const Context& context = {});

}  // namespace umtet
