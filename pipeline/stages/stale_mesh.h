#pragma once

#include <string>

#include "pipeline/case/case_folder.h"
#include "pipeline/case/record.h"

namespace umtet {

/// Why the mesh of a case is not of what the case holds now, as a clause: its cloud or level set was made again since,
/// or a file that it was made from, or a parameter of [mesh] in case.toml has another value. Empty where nothing of
/// this is so. Files that are gone have not changed, and another version of the program is no reason.
/// @param mesh  the record of 3-mesh
/// \throw ArtefactDamaged, std::system_error
std::string stale_reason(const CasePaths& paths, const StageRecord& mesh);

/// Refuses such a mesh, with the command that makes it again. Does nothing where there is no mesh.
/// \throw UsageError; as stale_reason()
void require_current_mesh(const CasePaths& paths);

}  // namespace umtet
