#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common/message.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Error for the content of a cloud file. what() is a sentence with the file, the location (line, byte or point number)
/// and the remedy.
struct CloudRefused : ExplainedError {
  using ExplainedError::ExplainedError;
};

/// Maximum number of fields; further fields are dropped.
inline constexpr std::size_t kMostFields = 16;

/// Properties of a cloud file besides the points.
struct CloudFileReport {
  std::string format;  ///< "ply ascii", "ply binary little endian", "pcd compressed", "text" ...
  std::size_t n_points = 0;
  std::size_t n_normals_rescaled = 0;  ///< normals that were not unit to 1e-3 and were normalised
  std::size_t n_points_dropped = 0;    ///< read_scan(): points with coordinates that are NaN, infinite or beyond 1e50
  std::size_t n_normals_missing = 0;   ///< read_scan(): zero, NaN or infinite normals; they are zero in the cloud
  bool of_triangles = false;           ///< samples of triangles: their normals are certain, and there are no outliers
  std::optional<Vec3> viewpoint = {};  ///< position of the scanner: VIEWPOINT of a .pcd file, unless it is 0 0 0 1 0 0
                                       ///< 0
  std::vector<std::string> fields_left_out = {};  ///< fields beyond the first kMostFields, or with a duplicate name
  std::string columns = {};  ///< for a text: its columns and how they were determined, in one line for the user
  bool columns_are_guessed = false;  ///< from their values; the argument `columns` of read_scan() overrules the guess
};

struct CloudFile {
  OrientedPointCloud cloud;
  CloudFileReport report;
};

}  // namespace umtet
