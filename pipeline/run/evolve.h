#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/case/exit_code.h"
#include "pipeline/case/parameters.h"
#include "pipeline/case/progress.h"
#include "pipeline/case/record.h"
#include "pipeline/meshing/part_mesher.h"

namespace umtet {

/// A moving domain: mesh.implicit containing t, or a list of clouds.
struct EvolveRequest {
  std::filesystem::path folder;
  std::filesystem::path clouds;  ///< list of clouds for time_steps(); empty: the formula
  std::string times, skip;       ///< arguments of time_steps()
  Parameters parameters;
  int threads = 1;
  PartMesher* ranks = nullptr;  ///< several processes that make the meshes
};

struct EvolveOutcome {
  Json steps = Json::array();  ///< one per step: t, file (null: not made), and measurements with verdict, or `error`
  std::vector<std::filesystem::path> files;
  std::string text;                   ///< summary in text
  ExitCode code = ExitCode::Success;  ///< GateFailed if a step could not be made, or its certificate failed
};

/// Meshes every instant in one background mesh: the tets of every mesh are tets of the background and carry its ids.
///
/// h is mesh.h, or the h that mesh.tets requests for the first instant, or the smallest h of choose_edge_length() for
/// all instants. The background covers mesh.box, or the boxes of all level sets. FOLDER/step_0000.vtu ... are the
/// meshes; series.pvd lists them with their times, quality.csv contains one line per step and quality.svg plots it.
/// These three files are complete after every step, so a stopped run leaves its results so far. Level sets of clouds
/// are kept in FOLDER/clouds/step_0000 ..., which are cases that later runs reuse. Former steps in FOLDER are removed
/// first.
///
/// If a cloud cannot be used or a mesh cannot be made, the instant is reported with its reason, and the others are
/// made.
/// \throw UsageError (also for a folder with other files), the failure if no instant has a psi, and all other
///   exceptions that failure_of() knows and that do not concern a single instant
EvolveOutcome evolve(const EvolveRequest& request, Progress& progress);

}  // namespace umtet
