#pragma once

#include <filesystem>
#include <vector>

#include "pipeline/case/case_folder.h"
#include "pipeline/case/progress.h"

namespace umtet {

/// Writes files for viewing the stages to CASE/5-view:
///   psi.vti    psi, as it was meshed, and |grad psi| on a grid of at most two million nodes
///   view.py    for `paraview --script=CASE/5-view/view.py`: samples, psi, psi = 0, a cut through the tets, the surface
///   without samples if there are holes, and the iterates if they were kept
/// @return the files. \throw UsageError  there is no mesh; ArtefactDamaged, Interrupted, Cancelled, std::system_error
std::vector<std::filesystem::path> write_view(const CasePaths& paths, Progress& progress);

}  // namespace umtet
