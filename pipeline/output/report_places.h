#pragma once

#include <string>

#include "pipeline/reports/certificate_report.h"

// Tables of places in report.html; empty where there are none. A button lets the viewer show what it is about.
namespace umtet {

/// The holes that were closed.
std::string hole_table(const Certificate& certificate);

/// Where samples are off the mesh.
std::string missed_table(const Certificate& certificate);

/// Where the mesh is not psi = 0.
std::string place_table(const Certificate& certificate);

}  // namespace umtet
