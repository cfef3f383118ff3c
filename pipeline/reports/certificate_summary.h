#pragma once

#include <string>

#include "pipeline/reports/certificate_report.h"

namespace umtet {

/// Returns three lines: what the mesh is, how good it is, and what is doubtful or to blame.
std::string short_summary(const Certificate& certificate);
/// Returns aligned lines of text: verdict, counts, quality, boundary, domain, cloud, time.
std::string summary(const Certificate& certificate);
/// Returns the shorter summary of a mesh that was checked.
std::string summary(const MeshCheck& check);

}  // namespace umtet
