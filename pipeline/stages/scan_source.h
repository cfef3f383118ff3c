#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/context.h"
#include "pipeline/case/parameters.h"
#include "pipeline/reports/stage_reports.h"
#include "reconstruct/io/point_cloud_io.h"
#include "reconstruct/io/triangle_mesh_io.h"

namespace umtet {

/// What was given as triangles and has been sampled.
struct SampledTriangles {
  TrianglesReport report;
  TriangleMesh boundary;             ///< the triangles that bound the body, outward
  std::vector<std::string> notices;  ///< what was mended, for the user
};

/// A scan as its file has it: points, or samples of triangles.
struct ScanSource {
  CloudFile cloud;
  std::optional<SampledTriangles> triangles;
};

/// STL, OBJ, OFF, and PLY with faces unless cloud.as_points. \throw std::system_error
bool is_of_triangles(const std::filesystem::path& source, const Parameters& parameters);

/// Reads points as they are, and samples triangles: at most cloud.sample_spacing apart, without normals for
/// cloud.normals = estimate, on the side that triangles look to for cloud.normals = given.
/// \throw CloudRefused  as the readers, or triangles that do not bound a body; std::system_error; Cancelled
ScanSource read_source(const std::filesystem::path& source, const Parameters& parameters, const Context& context = {});

/// Which columns of numbers were not taken along, and why; empty if all were.
std::string fields_left_out(const CloudFileReport& file);

/// Puts what is known of the triangles into the report of their samples, notices first.
void add_triangles(const SampledTriangles& triangles, CloudReport& report);

}  // namespace umtet
