#pragma once

#include <string>

#include "pipeline/case/case_folder.h"
#include "pipeline/case/record.h"

namespace umtet {

/// Returns a clause that explains why the mesh of a case is out of date: its cloud or level set, or a file from which
/// it was made, has been made again, or a parameter of [mesh] in case.toml has another value. Empty if the mesh is
/// current. Missing files do not count as changed, and another version of the program is not a reason.
/// @param mesh  the record of 3-mesh
/// \throw ArtefactDamaged, std::system_error
std::string stale_reason(const CasePaths& paths, const StageRecord& mesh);

/// Refuses a mesh that is out of date, and names the command that makes it again. Does nothing if there is no mesh.
/// \throw UsageError; the exceptions of stale_reason()
void require_current_mesh(const CasePaths& paths);

}  // namespace umtet
