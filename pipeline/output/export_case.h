#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/case/case_folder.h"
#include "pipeline/case/parameters.h"
#include "pipeline/case/progress.h"
#include "pipeline/meshing/part_mesher.h"

namespace umtet {

/// Returns the export formats: "vtu", "msh" (Gmsh 4.1), "msh22" (Gmsh 2.2), "mesh" (MEDIT), "inp" (Abaqus, CalculiX),
/// "bdf" (Nastran), "feb" (FEBio), "cdb" (Ansys), "xdmf" (with HDF5), "stl", "obj", "ply" (the boundary); for "pvtu"
/// and "pmsh" (Gmsh 4.1) each process writes its own part.
const std::vector<std::string>& export_formats();

/// Returns whether one of these formats can be written from a distributed mesh, and whether one of them consists of one
/// file per process.
bool takes_parts(const std::vector<std::string>& formats);
bool is_in_pieces(const std::vector<std::string>& formats);

/// \throw UsageError  an unknown format, with the nearest format
void require_formats(const std::vector<std::string>& formats);

/// Returns the exported files in the folder, sorted by name. Files of the user are not included.
std::vector<std::filesystem::path> exported_files(const CasePaths& paths);

/// Writes 4-export/mesh.<suffix> and related files for every format, from 3-mesh/mesh.vtu and the labels of
/// 1-cloud/cloud.ply, see divide_boundary(). The files of a format are moved into place when all of them are written.
/// @param parts  a distributed mesh, of which each process writes its part; null: there is one part
/// @return the files written
/// \throw UsageError  an unknown format, a case without a mesh, or the exceptions of divide_boundary();
///   ArtefactDamaged, Interrupted, std::system_error
std::vector<std::filesystem::path> export_case(const CasePaths& paths, const std::vector<std::string>& formats,
                                               const Parameters& parameters, Progress& progress,
                                               const MeshWithBoundary* parts = nullptr);

/// Returns whether `umtet regions` has made this folder: it contains regions.vtu and no case.toml.
bool has_regions(const std::filesystem::path& folder);

/// \throw UsageError  an unknown format, or pmsh, which is for one body
void require_formats_of_regions(const std::vector<std::string>& formats);

/// Writes FOLDER/4-export/mesh.<suffix> and related files of FOLDER/regions.vtu: a part for each region, a patch for
/// each interface and for the walls (set_regions()). In names of files '+' replaces the '|' of patches.
/// @return the files written
/// \throw the exception of require_formats_of_regions(); ArtefactDamaged, Interrupted, std::system_error
std::vector<std::filesystem::path> export_regions(const std::filesystem::path& folder,
                                                  const std::vector<std::string>& formats, Progress& progress);

}  // namespace umtet
