#pragma once

#include <vector>

#include "pipeline/case/case_folder.h"
#include "pipeline/case/parameters.h"
#include "pipeline/case/progress.h"
#include "pipeline/case/record.h"
#include "pipeline/domain/handover.h"
#include "pipeline/meshing/part_mesher.h"

namespace umtet {

class InputFile;

/// The arguments of every stage. A stage computes first and touches the case only when it has something to write; it
/// writes to paths.folder(), which is beside a finished folder if there is one.
struct StageContext {
  const CasePaths& paths;
  const Parameters& parameters;
  Progress& progress;
  int threads;
  Handover& handover;
  PartMesher* ranks = nullptr;  ///< several processes that make the mesh
};

/// 1-cloud: reads the user's file, checks it, and writes cloud.ply (double precision, original coordinates).
/// \throw CloudRefused, std::system_error; then the case is unchanged
void run_cloud_stage(const StageContext&, const InputFile& source);

/// 2-level-set: fits psi to cloud.ply and writes level_set.vti. A cloud far from the origin is fitted in coordinates
/// shifted by LevelSetReport::shift. \throw SolveError, Interrupted, ArtefactDamaged, std::system_error
void run_level_set_stage(const StageContext&);

/// 3-mesh: meshes {psi < 0} of the level set, or of mesh.implicit if it is set; writes omega_h.vtu, projected.vtu,
/// mesh.vtu and quality.csv, and stores all data for a certificate in the record.
/// If no mesh can be made, omega_h.vtu and projected.vtu are written to 3-mesh/failed for inspection; nothing else is
/// touched. \throw MeshingImpossible, ResourceLimit, Interrupted, ArtefactDamaged, ExpressionError, UsageError,
/// std::system_error
void run_mesh_stage(const StageContext&);

/// Returns the files that a stage reads from the case (not the user's cloud), with the stamps in the records of their
/// stages; empty for the first stage and for a formula.
std::vector<RecordedFile> recorded_inputs(const CasePaths&, Stage, const Parameters&);

/// Call it before the first write of a stage: creates its folder and removes files that a killed run left. If no
/// finished result is to be kept, the certificate is removed and case.toml written, so that the run can be resumed.
void begin_writing(const StageContext&, Stage);

/// Writes case.toml if it has changed.
void write_parameters(const CasePaths&, const Parameters&);

}  // namespace umtet
