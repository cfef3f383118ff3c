#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/case/parameters.h"
#include "pipeline/case/record.h"
#include "pipeline/reports/stage_reports.h"
#include "reconstruct/cloud/cloud_neighbours.h"
#include "reconstruct/io/point_cloud_io.h"

namespace umtet {

/// A cloud that can be fitted, and what had to be done to the scan for it.
struct PreparedCloud {
  OrientedPointCloud cloud;
  NeighbourDistances near;  ///< of its points, for areas; empty where preparing did not need them
  CloudReport report;
};

/// \throw CloudRefused  a device, a pipe or a folder: there is no telling where it ends
void require_regular_file(const std::filesystem::path& file);

/// The files that 1-cloud reads: the user's cloud, and the viewpoints of cloud.orient_from.
/// \throw CloudRefused (not a regular file), std::system_error
std::vector<RecordedFile> source_inputs(const std::filesystem::path& source, const Parameters& parameters,
                                        FileStamps& stamps);

/// Sorts a scan in space, cleans it and gives every point an outward normal, as the parameters of the section `cloud`
/// say.
///
/// Normals that came with the scan are scored, and a minority that is turned over is turned back (normals = auto),
/// taken as they are (given) or thrown away (estimate). Missing ones are estimated. cloud.orient_from and cloud.flip
/// have the last word.
///
/// \throw CloudRefused  fewer than 10 points are left; not a file of viewpoints
PreparedCloud prepare_cloud(CloudFile file, const std::filesystem::path& source, const Parameters& parameters);

}  // namespace umtet
