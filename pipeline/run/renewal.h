#pragma once

#include "pipeline/stages/stages.h"

namespace umtet {

/// If a stage is finished, it is made again beside the former result, in CASE/.next, and replaces it when all stages of
/// the call are done. A run that fails or is stopped thus leaves the case and its certificate unchanged.

/// Returns whether the stage, or a stage made from it, is finished: then it must not be made in place.
bool holds_results(const CasePaths&, Stage);

/// \throw UsageError  there is no case.toml, but there are files that no run of umtet has finished
void refuse_foreign_folder(const CasePaths&);

/// Moves the stages of paths.renewed into place and empties CASE/.next. The certificate and the exported files of a
/// mesh that is replaced are removed first, and each stage's record is replaced last: a killed run may leave stages
/// missing, but no record of files that do not exist. Afterwards paths.renewed is empty.
/// @param context  context.paths is `paths`
/// @param made     stages made by this run; their copies in CASE/.next are superseded if nothing is renewed
/// \throw std::system_error
void replace_former(const StageContext& context, CasePaths& paths, const std::vector<Stage>& made);

}  // namespace umtet
