#pragma once

#include <filesystem>
#include <vector>

#include "pipeline/case/case_folder.h"
#include "pipeline/case/parameters.h"
#include "pipeline/case/progress.h"
#include "pipeline/case/record.h"
#include "pipeline/domain/handover.h"
#include "pipeline/meshing/part_mesher.h"

namespace umtet {

/// What every stage is given. A stage computes first and touches the case only when it has something to write; it
/// writes to paths.folder(), which is beside the finished one where there is one.
struct StageContext {
  const CasePaths& paths;
  const Parameters& parameters;
  Progress& progress;
  int threads;
  Handover& handover;
  PartMesher* ranks = nullptr;  ///< who make the mesh, where several processes do
};

/// 1-cloud: reads the user's file, checks it, writes cloud.ply (double precision, original coordinates).
/// \throw CloudRefused, std::system_error; the case is then untouched
void run_cloud_stage(const StageContext&, const std::filesystem::path& source);

/// 2-level-set: fits psi to cloud.ply, writes level_set.vti. A cloud far from the origin is fitted in coordinates
/// shifted by LevelSetReport::shift. \throw SolveError, Interrupted, ArtefactDamaged, std::system_error
void run_level_set_stage(const StageContext&);

/// 3-mesh: meshes {psi < 0} of the level set, or of mesh.implicit when that is set; writes omega_h.vtu, projected.vtu,
/// mesh.vtu and quality.csv, and puts everything a certificate needs into the record.
/// When no mesh can be made, omega_h.vtu and projected.vtu go to 3-mesh/failed, to be looked at; nothing else is
/// touched. \throw MeshingImpossible, ResourceLimit, Interrupted, ArtefactDamaged, ExpressionError, UsageError,
/// std::system_error
void run_mesh_stage(const StageContext&);

/// The files a stage reads from the case (not the user's cloud), with the stamps that the records of their stages hold;
/// empty for the first stage and for a formula.
std::vector<RecordedFile> recorded_inputs(const CasePaths&, Stage, const Parameters&);

/// To call before the first write of a stage: makes its folder and removes from it what a killed run left. Where
/// nothing finished is to be kept, the certificate is withdrawn and case.toml written, so that the run can be resumed.
void begin_writing(const StageContext&, Stage);

/// Writes case.toml if it is not the same already.
void write_parameters(const CasePaths&, const Parameters&);

}  // namespace umtet
