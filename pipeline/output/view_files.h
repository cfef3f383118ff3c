#pragma once

#include <filesystem>
#include <vector>

#include "pipeline/case/case_folder.h"
#include "pipeline/case/progress.h"

namespace umtet {

/// Files to look at the stages with, in CASE/5-view:
///   psi.vti    psi, as it was meshed, and |grad psi| on a grid of at most two million nodes
///   zero.vtp   psi = 0: the surface of that grid's linear interpolant, its vertices moved on by one step of Newton's
///              method; with |grad psi|
///   view.py    `paraview --script=CASE/5-view/view.py`: samples, psi, psi = 0, a cut through the tets, the surface
///              that no sample supports where there are holes, and the iterates where they were kept
/// @return the files. \throw UsageError without a mesh; ArtefactDamaged, Interrupted, Cancelled, std::system_error
std::vector<std::filesystem::path> write_view(const CasePaths& paths, Progress& progress);

}  // namespace umtet
