#pragma once

#include <string>

#include "pipeline/reports/certificate_report.h"

// Tables of defects, holes and groups of missed samples in report.html; empty if there are none. Each row with a button
// lets the viewer show its location.
namespace umtet {

/// Returns the table of holes that were closed.
std::string hole_table(const Certificate& certificate);

/// Returns the table of samples that the mesh misses.
std::string missed_table(const Certificate& certificate);

/// Returns the table of defects, where the mesh is not psi = 0.
std::string defect_table(const Certificate& certificate);

}  // namespace umtet
