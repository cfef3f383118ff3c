#pragma once

#include <filesystem>
#include <string>

#include "pipeline/case/progress.h"
#include "pipeline/case/record.h"

namespace umtet {

/// What is in a cloud file: counts, box, spacing, normals, noise, thickness, and under `trouble` what is likely to go
/// wrong, each with its remedy. Nothing is changed and nothing is written.
/// \throw CloudRefused, std::system_error
Json inspect_cloud(const std::filesystem::path& file, Progress& progress);

/// The same in lines for people.
std::string inspection_text(const Json& inspection);

}  // namespace umtet
