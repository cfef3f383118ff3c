#pragma once

#include "body/regions/region_bodies.h"
#include "pipeline/case/json_values.h"

namespace umtet {

/// Returns the contents of regions.json: verdict, the whole mesh, each region, each interface, samples and defects.
Json document_of_regions(const RegionBodyMesh& made);

}  // namespace umtet
