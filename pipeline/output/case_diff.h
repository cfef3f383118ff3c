#pragma once

#include <string>

#include "pipeline/case/case_folder.h"
#include "pipeline/case/progress.h"
#include "pipeline/case/record.h"

namespace umtet {

/// Where two cases part: per stage whether its files are the same, which parameters and recorded numbers differ, and by
/// how much its result does:
///   cloud       distance of every sample to the next of the other case
///   level-set   |psi_a - psi_b| at the samples of A
///   mesh        distance of boundary vertices to the other's boundary; if the tets are the same, moves of the vertices
/// `first_difference` is the first stage whose files differ, or null.
/// \throw UsageError for what is no case; ArtefactDamaged, Interrupted, Cancelled, std::system_error
Json diff_cases(const CasePaths& a, const CasePaths& b, Progress& progress);

/// The same for people, some lines a stage.
std::string diff_text(const Json& diff);

}  // namespace umtet
