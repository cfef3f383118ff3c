#pragma once

#include <string>

#include "pipeline/reports/certificate_report.h"

namespace umtet {

/// Returns a few aligned lines of text: verdict, counts, quality, boundary, domain, cloud, time.
std::string summary(const Certificate& certificate);
/// Returns the shorter summary of a mesh that was checked.
std::string summary(const MeshCheck& check);

}  // namespace umtet
