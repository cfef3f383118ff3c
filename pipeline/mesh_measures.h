#pragma once

#include <string>
#include <vector>

#include "mesh/certificate.h"
#include "mesh/universal_mesh.h"
#include "mesh/zero_set.h"
#include "pipeline/domain.h"
#include "pipeline/record.h"

namespace umtet {

/// The pieces of psi = 0, counted on a grid of its own, and which of them are meshed.
struct ZeroSetChoice {
  ZeroSetTopology topology;
  std::vector<Vec3> seeds;           ///< one point of each piece that is kept
  std::vector<std::string> dropped;  ///< for each of the others, why
};

/// Pieces of a level set that no sample backs are artefacts of the fit: a piece is dropped when no sample is within
/// three sample spacings of its box. A formula has no artefacts: all its pieces are kept.
/// @param h  edge length of the mesh to come; the grid is no coarser
ZeroSetChoice choose_components(const Domain& domain, double h);

/// The fields of the certificate that are measured, in its order: n_points ... resolution, then `reasons`, the list of
/// what is wrong with the mesh. Fields that this input does not have are null.
Json measure(const Domain& domain, const UmResult& result, const ZeroSetChoice& pieces, double h);

/// The blocks `quality` and `boundary` and the counts before them.
Json to_json(const MeshCertificate& certificate);

}  // namespace umtet
