#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/context.h"
#include "common/message.h"
#include "pipeline/case/parameters.h"
#include "pipeline/case/record.h"
#include "pipeline/reports/stage_reports.h"
#include "reconstruct/io/input_file.h"
#include "reconstruct/io/point_cloud_io.h"
#include "reconstruct/io/triangle_mesh_io.h"

namespace umtet {

/// Input triangles that have been sampled.
struct SampledTriangles {
  TrianglesReport report;
  TriangleMesh boundary;         ///< the triangles that bound the body, facing outward
  std::vector<Message> notices;  ///< repairs that the user should know about
};

/// The contents of a scan file: points, or samples of triangles.
struct ScanSource {
  CloudFile cloud;
  std::optional<SampledTriangles> triangles;
};

/// Opens a scan file.
/// \throw CloudRefused  a device, a pipe or a folder: their size is unknown; std::system_error
std::shared_ptr<const InputFile> open_source(const std::filesystem::path& file);

/// Returns the files that 1-cloud reads: the user's cloud, the viewpoints of cloud.orient_from, and the edges of
/// cloud.features.
/// \throw CloudRefused  the beginning of the cloud is not that of a scan, or one of the others is not a regular file or
///   too large; std::system_error
std::vector<RecordedFile> source_inputs(const InputFile& source, const Parameters& parameters, FileStamps& stamps);

/// Returns whether the file contains triangles: STL, OBJ, OFF, and PLY with faces unless cloud.as_points.
bool is_of_triangles(const InputFile& source, const Parameters& parameters);

/// Reads points as they are, and samples triangles with a spacing of at most cloud.sample_spacing. Samples have no
/// normals for cloud.normals = estimate, and the sides of the triangles for cloud.normals = given.
/// \throw CloudRefused  the exceptions of the readers, or triangles that do not bound a body; std::system_error;
///   Cancelled
ScanSource read_source(const InputFile& source, const Parameters& parameters, const Context& context = {});

/// Adds the report on triangles to the report of their samples, notices first.
void add_triangles(const SampledTriangles& triangles, CloudReport& report);

}  // namespace umtet
