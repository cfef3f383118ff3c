#pragma once

#include <filesystem>

#include "pipeline/output/case_diff.h"

namespace umtet {

/// Writes a page like report.html that shows the boundaries of two meshes, or else psi = 0 of two cases, coloured by
/// their distance to each other, and the text of the comparison.
/// @return false if there is nothing to show: the files are equal, or a case has no level set
/// \throw ArtefactDamaged, Interrupted, Cancelled, std::system_error
bool write_diff_page(const std::filesystem::path& file, const CasePaths& a, const CasePaths& b, const CaseDiff& diff);

}  // namespace umtet
