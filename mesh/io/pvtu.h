#pragma once

#include <map>
#include <string>
#include <vector>

#include "mesh/io/tet_mesh_io.h"

namespace umtet {

/// Text of a .pvtu file whose pieces all contain these arrays; values are not used.
/// @param pieces  names of .vtu files in the same folder
std::string pvtu_text(const std::map<std::string, FieldValues>& point_data,
                      const std::map<std::string, FieldValues>& cell_data, const std::vector<std::string>& pieces);

}  // namespace umtet
