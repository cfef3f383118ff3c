#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "body/body.h"
#include "body/search/mesh_attempts.h"
#include "pipeline/stages/stages.h"

namespace umtet {

/// Writes all files of the mesh stage except its record to 3-mesh/, and replaces the files of the former run:
/// omega_h.vtu, projected.vtu, mesh.vtu, quality.csv; features.vtp of a body with sharp edges;
/// too_thin.vtp and defects.vtp if there are thin places or defects;
/// pass_N.vtu and iterates.pvd if iterates were kept. If they were not kept, omega_h.vtu and projected.vtu contain only
/// tets with a vertex that moves; the others are in mesh.vtu. The contents of mesh.vtu are handed over to later stages.
/// @param best  its tets, their ids and the chosen vertices are moved out
/// @return the names of the files. \throw Cancelled, std::system_error  names the file
std::vector<std::string> write_mesh_outputs(const StageContext& context, const Domain& domain, MeshAttempt& best);

/// Writes the remains of a mesh that failed, or is incorrect, to 3-mesh/failed/, which is emptied first: omega_h.vtu
/// and, as projected.vtu, the last iterate. @return that folder. \throw std::system_error  names the file
std::filesystem::path write_failed_mesh(const CasePaths& paths, const Domain& domain, const UmResult& result);

}  // namespace umtet
