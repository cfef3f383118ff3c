#pragma once

#include <string>
#include <vector>

#include "mesh/regions/region_certificate.h"
#include "mesh/regions/region_mesh.h"
#include "pipeline/case/json_values.h"

namespace umtet {

/// Returns the contents of regions.json: the whole mesh, each region, each interface, defects and verdict.
/// @param names    per region
/// @param reasons  failures(); empty: the mesh passes
Json document_of_regions(const RegionCertificate& certificate, const RegionMesh& mesh,
                         const std::vector<std::string>& names, const std::vector<std::string>& reasons);

}  // namespace umtet
