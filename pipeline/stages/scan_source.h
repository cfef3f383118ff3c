#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/context.h"
#include "pipeline/case/parameters.h"
#include "pipeline/case/record.h"
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

/// \throw CloudRefused  a device, a pipe or a folder: there is no telling where it ends
void require_regular_file(const std::filesystem::path& file);

/// The files that 1-cloud reads: the user's cloud, and the viewpoints of cloud.orient_from.
/// \throw CloudRefused (not a regular file), std::system_error
std::vector<RecordedFile> source_inputs(const std::filesystem::path& source, const Parameters& parameters,
                                        FileStamps& stamps);

/// STL, OBJ, OFF, and PLY with faces unless cloud.as_points. \throw std::system_error
bool is_of_triangles(const std::filesystem::path& source, const Parameters& parameters);

/// Reads points as they are, and samples triangles: at most cloud.sample_spacing apart, without normals for
/// cloud.normals = estimate, on the side that triangles look to for cloud.normals = given.
/// \throw CloudRefused  as the readers, or triangles that do not bound a body; std::system_error; Cancelled
ScanSource read_source(const std::filesystem::path& source, const Parameters& parameters, const Context& context = {});

/// Puts what is known of the triangles into the report of their samples, notices first.
void add_triangles(const SampledTriangles& triangles, CloudReport& report);

}  // namespace umtet
