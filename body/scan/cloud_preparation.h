#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "body/options.h"
#include "body/scan/scan_reports.h"
#include "reconstruct/cloud/cloud_file.h"
#include "reconstruct/cloud/neighbours/cloud_neighbours.h"

namespace umtet {

/// What the preparation did to a sample, or doubts about it.
enum class SampleMark : std::uint8_t {
  Outlier = 1,         ///< dropped: far from a surface, or inside or outside of what the samples enclose
  SmallComponent = 2,  ///< dropped with a small piece far from the rest
  NoNormal = 3,        ///< dropped: its neighbours define no normal
  Turned = 4,          ///< its given normal was turned over
  Doubtful = 5,        ///< its outward side is a guess
};

struct MarkedSample {
  Vec3 where;  ///< model coordinates
  SampleMark mark;
};

/// A cloud that is ready for the fit, and a report of the changes to the scan.
struct PreparedCloud {
  OrientedPointCloud cloud;
  /// Neighbour distances of the points, for sample areas; empty if the preparation did not need them.
  NeighbourDistances near;
  CloudReport report;
  std::vector<MarkedSample> marked;  ///< a sample may occur with several marks
};

/// Sorts the points of a scan in space, drops unusable points (CloudReport::dropped), and gives every point an outward
/// normal, according to ScanOptions.
///
/// The treatment of the normals of the scan depends on ScanOptions::normals. Auto: their consistency is measured, and a
/// reversed minority is turned over. Given: they stay unchanged. Estimate: they are discarded. Missing normals are
/// estimated. Viewpoints and ScanOptions::flip are applied last.
///
/// @param name  name of the scan in messages
/// \throw CloudRefused  fewer than 10 points remain; also any exception of options.viewpoints
PreparedCloud prepare_cloud(CloudFile file, const std::string& name, const BodyOptions& options);

/// Returns a text that lists the columns of the file that were ignored, with reasons; empty if all were used.
std::string fields_left_out(const CloudFileReport& file);

}  // namespace umtet
