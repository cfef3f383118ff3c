#pragma once

#include <string>

#include "body/options.h"
#include "body/scan/scan_reports.h"
#include "reconstruct/cloud/cloud_file.h"
#include "reconstruct/cloud/neighbours/cloud_neighbours.h"

namespace umtet {

/// A cloud that can be fitted, and what had to be done to the scan for it.
struct PreparedCloud {
  OrientedPointCloud cloud;
  NeighbourDistances near;  ///< of its points, for areas; empty where preparing did not need them
  CloudReport report;
};

/// Sorts a scan in space, cleans it and gives every point an outward normal, as ScanOptions say.
///
/// Normals that came with the scan are scored, and a minority that is turned over is turned back (normals = auto),
/// taken as they are (given) or thrown away (estimate). Missing ones are estimated. Viewpoints and ScanOptions::flip
/// have the last word.
///
/// @param name  of the scan, for messages
/// \throw CloudRefused  fewer than 10 points are left; what options.viewpoints throws
PreparedCloud prepare_cloud(CloudFile file, const std::string& name, const BodyOptions& options);

/// Which columns of numbers were not taken along, and why; empty if all were.
std::string fields_left_out(const CloudFileReport& file);

}  // namespace umtet
