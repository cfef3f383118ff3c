#pragma once

#include <optional>
#include <string>

#include "pipeline/case/case_folder.h"
#include "pipeline/case/exit_code.h"

namespace umtet {

/// The end of a run that made no mesh: CASE/failure.json. The next run of the case that succeeds removes it.
struct CaseFailure {
  Stage stage = Stage::Cloud;  ///< the stage that was at work
  ExitCode code = ExitCode::Bug;
  std::string message;
};

/// Writes the file atomically if the case contains a finished stage or the remains of a mesh, and no certified mesh of
/// a former run, which stays its result; else does nothing. \throw std::system_error
void write_failure(const CasePaths& paths, const CaseFailure& failure);
/// Returns the failure of the last run; none if it succeeded, or if the file is damaged.
std::optional<CaseFailure> read_failure(const CasePaths& paths);
void remove_failure(const CasePaths& paths);

}  // namespace umtet
