#pragma once

#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// The content of a cloud file was refused. what() is one sentence: file, place (line, byte or point number), remedy.
struct CloudRefused : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// More of them are left out.
inline constexpr std::size_t kMostFields = 16;

/// What was found in a cloud file besides the points.
struct CloudFileReport {
  std::string format;  ///< "ply ascii", "ply binary little endian", "pcd compressed", "text" ...
  std::size_t n_points = 0;
  std::size_t n_normals_rescaled = 0;  ///< normals that were not unit to 1e-3 and have been made so
  std::size_t n_points_dropped = 0;    ///< read_scan: coordinates NaN, infinite or beyond 1e50
  std::size_t n_normals_missing = 0;   ///< read_scan: zero, NaN or infinite; they are zero in the cloud
  bool of_triangles = false;           ///< samples of triangles: their normals are sure, and there is no outlier
  std::optional<Vec3> viewpoint = {};  ///< where the scanner stood: VIEWPOINT of a .pcd, unless it is 0 0 0 1 0 0 0
  std::vector<std::string> fields_left_out = {};  ///< beyond the first kMostFields, or of a name that is there twice
  std::string columns = {};  ///< of a text: what its columns are and how that is known, in one line for the user
};

struct CloudFile {
  OrientedPointCloud cloud;
  CloudFileReport report;
};

}  // namespace umtet
