#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "body/body.h"
#include "body/search/mesh_attempts.h"
#include "pipeline/stages/stages.h"

namespace umtet {

/// The files of the mesh stage but for its record, all in 3-mesh/, in place of those of the former run: omega_h.vtu,
/// projected.vtu, mesh.vtu, quality.csv; too_thin.vtp and places.vtp where there are such places; pass_N.vtu and
/// iterates.pvd where iterates were kept. Unless they were, omega_h.vtu and projected.vtu hold the tets with a vertex
/// that moves: the others are those of mesh.vtu. What mesh.vtu holds is handed over to the stages to come.
/// @param best  gives its tets, their ids and the chosen vertices away
/// @return their names. \throw Cancelled, std::system_error naming the file
std::vector<std::string> write_mesh_outputs(const StageContext& context, const Domain& domain, MeshAttempt& best);

/// What is left of a mesh that is none, or is not right, into 3-mesh/failed/, emptied before: omega_h.vtu and, as
/// projected.vtu, the last iterate. @return that folder. \throw std::system_error naming the file
std::filesystem::path write_failed_mesh(const CasePaths& paths, const Domain& domain, const UmResult& result);

}  // namespace umtet
