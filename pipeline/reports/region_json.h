#pragma once

#include <string>
#include <vector>

#include "body/regions/region_bodies.h"
#include "pipeline/case/json_values.h"

namespace umtet {

/// Returns the measures of each region: its certificate, its pieces.
Json json_of_regions(const RegionCertificate& certificate, const std::vector<std::string>& names);
/// Returns the measures of each interface.
/// @param is_compared  whether the interfaces were compared with their sheets; if not, these values are null
Json json_of_interfaces(const RegionCertificate& certificate, const std::vector<std::string>& names, bool is_compared);

/// Returns the contents of regions.json: verdict, the whole mesh, each region, each interface, samples and defects.
Json document_of_regions(const RegionBodyMesh& made);

}  // namespace umtet
