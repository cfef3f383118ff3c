#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/case_folder.h"
#include "pipeline/progress.h"

namespace umtet {

/// "msh" (Gmsh 4.1), "msh22" (Gmsh 2.2), "mesh" (MEDIT), "vtu", "stl" (the boundary).
const std::vector<std::string>& export_formats();

/// Where a format goes.
std::filesystem::path exported_file(const CasePaths& paths, const std::string& format);

/// Writes 4-export/mesh.<suffix> for every format, from 3-mesh/mesh.vtu.
/// @return the files written
/// \throw UsageError for an unknown format (names the nearest) or a case without a mesh; ArtefactDamaged,
///        Interrupted, std::system_error
std::vector<std::filesystem::path> export_case(const CasePaths& paths, const std::vector<std::string>& formats,
                                               Progress& progress);

}  // namespace umtet
