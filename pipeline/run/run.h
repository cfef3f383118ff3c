#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/case/exit_code.h"
#include "pipeline/case/parameters.h"
#include "pipeline/case/progress.h"
#include "pipeline/case/record.h"
#include "pipeline/meshing/part_mesher.h"
#include "pipeline/reports/certificate_report.h"

namespace umtet {

/// What a call wants of the stages.
struct RunRequest {
  std::filesystem::path case_folder;
  std::filesystem::path source;  ///< the cloud; empty: the case has its own, or there is a formula
  Parameters parameters;
  Stage from = Stage::Cloud, until = Stage::Mesh;
  bool fresh = false;   ///< nothing but the input is taken from former calls
  bool force = false;   ///< run the stages from..until although they are done
  bool strict = false;  ///< a damaged artefact is an error instead of a reason to make it again
  bool report = true;   ///< make report.html beside a certificate
  int threads = 1;
  PartMesher* ranks = nullptr;  ///< who make the mesh, where several processes do
  bool keeps_parts = false;     ///< what each of `ranks` has of it is wanted afterwards
  bool needs_parts = false;     ///< so much that the mesh is made although it is done
  /// Of the files that are known by now; after the run those of the case, too.
  std::shared_ptr<FileStamps> stamps = std::make_shared<FileStamps>();
};

struct RunOutcome {
  std::vector<Stage> stages_run;
  std::vector<std::string> kept;                  ///< from former calls: Parameters::kept()
  std::vector<std::string> changed;               ///< against former calls: differences() of all sections
  std::optional<Certificate> certificate;         ///< when 3-mesh is done and part of the call
  std::vector<std::filesystem::path> files;       ///< that the user may want to open
  std::shared_ptr<const MeshWithBoundary> parts;  ///< where they were to be kept
  ExitCode code = ExitCode::Success;              ///< Success, or GateFailed when the verdict is fail
};

/// Brings a case to the state that a call wants: every stage up to `until` whose record does not match is run again,
/// those before `from` are taken as they are while they are whole. Holds the lock of the case meanwhile.
/// \throw everything that failure_of() knows
RunOutcome run_case(const RunRequest& request, Progress& progress);

}  // namespace umtet
