#pragma once

#include <string>
#include <vector>

#include "mesh/regions/region_certificate.h"

namespace umtet {

/// Returns a table of the regions of a mesh, and a line for each interface.
/// @param names        by region
/// @param is_compared  whether the interfaces were compared with their sheets
std::string region_lines(const RegionCertificate& certificate, const std::vector<std::string>& names, bool is_compared);

}  // namespace umtet
