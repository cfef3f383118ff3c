#pragma once

#include <string>

#include "pipeline/case/case_folder.h"

namespace umtet {

/// Returns a line about the normals of the file before any were turned, for a fit or a mesh that has failed; empty if
/// they do not explain the failure. Reads the record of the cloud.
std::string doubt_about_given_normals(const CasePaths& paths);

}  // namespace umtet
