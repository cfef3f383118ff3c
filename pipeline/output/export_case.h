#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/case/case_folder.h"
#include "pipeline/case/parameters.h"
#include "pipeline/case/progress.h"
#include "pipeline/meshing/part_mesher.h"

namespace umtet {

/// "vtu", "msh" (Gmsh 4.1), "msh22" (Gmsh 2.2), "mesh" (MEDIT), "inp" (Abaqus, CalculiX), "bdf" (Nastran), "feb"
/// (FEBio), "xdmf" (with HDF5), "stl", "obj", "ply" (the boundary); "pvtu" and "pmsh" (Gmsh 4.1), of which each process
/// writes its own part.
const std::vector<std::string>& export_formats();

/// Whether one of these is written of what several processes have, and whether one of them is in pieces.
bool takes_parts(const std::vector<std::string>& formats);
bool is_in_pieces(const std::vector<std::string>& formats);

/// \throw UsageError  a format that is none of them, with the nearest
void require_formats(const std::vector<std::string>& formats);

/// The exported files that are in the folder now, in the order of their names; files of the user are none of them.
std::vector<std::filesystem::path> exported_files(const CasePaths& paths);

/// Writes 4-export/mesh.<suffix> and what belongs to it for every format, from 3-mesh/mesh.vtu and the labels of
/// 1-cloud/cloud.ply, see divide_boundary(). The files of a format
/// take their places when all of them are written.
/// @param parts  of a mesh of several processes, each of which writes a piece; null: there is one piece
/// @return the files written
/// \throw UsageError for an unknown format, a case without a mesh, and as divide_boundary(); ArtefactDamaged,
/// Interrupted, std::system_error
std::vector<std::filesystem::path> export_case(const CasePaths& paths, const std::vector<std::string>& formats,
                                               const Parameters& parameters, Progress& progress,
                                               const MeshWithBoundary* parts = nullptr);

}  // namespace umtet
