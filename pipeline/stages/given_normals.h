#pragma once

#include <string>

#include "pipeline/case/case_folder.h"

namespace umtet {

/// A line on what the normals of the file were like before any were turned, for a fit or a mesh that has failed; empty
/// if that explains nothing. Reads the record of the cloud.
std::string doubt_about_given_normals(const CasePaths& paths);

}  // namespace umtet
