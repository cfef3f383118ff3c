#pragma once

#include <vector>

#include "body/body.h"
#include "body/fidelity/mesh_edge.h"
#include "body/fidelity/mesh_measures.h"
#include "body/pieces/zero_set_choice.h"
#include "body/sizing/too_thin.h"
#include "mesh/sizes/size_field.h"
#include "mesh/universal_mesh.h"

namespace umtet {

/// What is true of the corners of a mesh, and everywhere that it is not psi = 0.
struct Measurement {
  MeshMeasures measures;
  std::vector<MeshDefect> defects;  ///< all of them, in the order of measures.defects.listed
};

/// What else a mesh is held against.
struct MeasureParams {
  const ThinPlaces* thin = nullptr;  ///< of psi as it was meshed; null: not looked for
  double max_deviation = 0;          ///< of face centres from psi = 0, model units: more is a reason; 0: any will do
  const SizeField* sizes = nullptr;  ///< that a graded mesh was made for
  /// Of the whole mesh, where the result has its boundary only; null: it is made of the result.
  const MeshCertificate* certificate = nullptr;
};

/// The edge length that a mesh was made with: in a background that is no lattice, at each vertex of the boundary.
/// @param h  that the background was asked to have
MeshEdge mesh_edge(const BackgroundMesh& background, const UmResult& result, double h);

/// @param mesh    the tets of the result, with its final vertices
/// @param result  all else of it
/// @param h  that the mesh was made with. \throw Cancelled
Measurement measure(const Domain& domain, const TetMesh& mesh, const UmResult& result, const ZeroSetChoice& pieces,
                    const MeshEdge& h, const MeasureParams& params = {}, const Context& context = {});

/// What the certificate of a mesh says that was made elsewhere.
/// @param domain  of the psi that it was certified with; null: without
MeshMeasures measures_of(MeshCertificate certificate, const Domain* domain, const Context& context = {});

}  // namespace umtet
