#pragma once

#include <string>

#include "pipeline/reports/certificate_report.h"

namespace umtet {

/// A few aligned lines for people: verdict, counts, quality, boundary, domain, cloud, time.
std::string summary(const Certificate& certificate);
/// The shorter ones of a mesh that was checked.
std::string summary(const MeshCheck& check);

}  // namespace umtet
