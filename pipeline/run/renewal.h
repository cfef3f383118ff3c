#pragma once

#include "pipeline/stages/stages.h"

namespace umtet {

/// Finished stages are made anew beside the former ones, in CASE/.next, and take their place when all stages of the
/// call are done: a run that fails or is stopped leaves the case as it was, with its certificate.

/// True when the stage, or one made from it, is finished: then it must not be made in place.
bool holds_results(const CasePaths&, Stage);

/// \throw UsageError when there is no case.toml, but files in the way that no run of ours has finished
void refuse_foreign_folder(const CasePaths&);

/// Puts the stages of paths.renewed in their places and empties CASE/.next. The certificate and the exported files of a
/// mesh that is replaced are withdrawn before, each stage's record is replaced last: killed on the way, stages are
/// missing, but none claims what is not there. Then paths.renewed is empty.
/// @param context  context.paths is `paths`
/// @param made     stages made by this run; what CASE/.next holds of them is superseded where nothing is renewed
/// \throw std::system_error
void replace_former(const StageContext& context, CasePaths& paths, const std::vector<Stage>& made);

}  // namespace umtet
