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

/// A domain that moves: mesh.implicit with t in it, or a list of clouds.
struct EvolveRequest {
  std::filesystem::path folder;
  std::filesystem::path clouds;  ///< the list of time_steps(); empty: the formula
  std::string times, skip;       ///< of time_steps()
  Parameters parameters;
  int threads = 1;
  PartMesher* ranks = nullptr;  ///< who make the meshes, where several processes do
};

struct EvolveOutcome {
  Json steps = Json::array();  ///< by step: t, file (null: not made), and what is measured with its verdict, or `error`
  std::vector<std::filesystem::path> files;
  std::string text;                   ///< for people
  ExitCode code = ExitCode::Success;  ///< GateFailed when a step could not be made, or its certificate failed
};

/// Meshes every instant in one background mesh: the tets of every mesh are tets of it, and carry its ids.
///
/// h is mesh.h; or what mesh.tets asks of the first instant; or the least that the instants get from
/// choose_edge_length(). The background covers mesh.box, or the boxes of all level sets. FOLDER/step_0000.vtu ... are
/// the meshes; series.pvd lists them with their times, quality.csv has a line a step and quality.svg plots it: these
/// three are complete after every step, so that a run that is stopped leaves what it has made. Level sets of clouds are
/// kept in FOLDER/clouds/step_0000 ..., cases that another run takes up. Former steps in FOLDER are removed first.
///
/// An instant with a cloud that cannot be used, or a mesh that cannot be made, is named with its reason; the others are
/// made.
/// \throw UsageError (also for a folder with other files), and what failed when no instant has a psi; everything else
///        that failure_of() knows and that is no fault of one instant
EvolveOutcome evolve(const EvolveRequest& request, Progress& progress);

}  // namespace umtet
