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
#include "reconstruct/io/input_file.h"

namespace umtet {

/// The request of a call for stages.
struct RunRequest {
  std::filesystem::path case_folder;
  std::filesystem::path source;  ///< the cloud; empty: the case has its own cloud, or there is a formula
  /// `source` if it is open already, else null: the run opens it.
  std::shared_ptr<const InputFile> input;
  Parameters parameters;
  Stage from = Stage::Cloud, until = Stage::Mesh;
  bool fresh = false;   ///< take only the input of the case from former calls
  bool force = false;   ///< run the stages from..until even if they are done
  bool strict = false;  ///< report a damaged artefact as an error instead of making it again
  bool report = true;   ///< make report.html beside a certificate
  int threads = 1;
  PartMesher* ranks = nullptr;  ///< several processes that make the mesh
  bool keeps_parts = false;     ///< keep the local mesh of each of `ranks` afterwards
  bool needs_parts = false;     ///< make the mesh for that purpose even if it is done
  /// Stamps of the files that are known before the run; afterwards also of the files of the case.
  std::shared_ptr<FileStamps> stamps = std::make_shared<FileStamps>();
};

struct RunOutcome {
  std::vector<Stage> stages_run;
  std::vector<std::string> kept;                  ///< parameters from former calls: Parameters::kept()
  std::vector<std::string> changed;               ///< changes from former calls: differences() of all sections
  std::optional<Certificate> certificate;         ///< set if 3-mesh is done and part of the call
  std::vector<std::filesystem::path> files;       ///< files that the user may want to open
  std::shared_ptr<const MeshWithBoundary> parts;  ///< set if they were to be kept
  ExitCode code = ExitCode::Success;              ///< Success, or GateFailed if the verdict is fail
};

/// Brings a case to the requested state: every stage up to `until` whose record does not match is run again, and
/// complete stages before `from` are taken as they are. Holds the lock of the case meanwhile.
/// \throw all exceptions that failure_of() knows
RunOutcome run_case(const RunRequest& request, Progress& progress);

}  // namespace umtet
