#pragma once

#include <map>
#include <string>
#include <vector>

#include "mesh/io/tet_mesh_io.h"

namespace umtet {

/// A .pvtu of pieces that all have these arrays; their values do not matter.
/// @param pieces  names of .vtu files in the same folder
std::string pvtu_text(const std::map<std::string, FieldValues>& point_data,
                      const std::map<std::string, FieldValues>& cell_data, const std::vector<std::string>& pieces);

}  // namespace umtet
