#pragma once

#include <optional>

#include "pipeline/case/json_fields.h"
#include "pipeline/reports/certificate_report.h"

// Comparison of a mesh with psi = 0, samples, triangles and requested sizes. docs/reference.md explains the names.
namespace umtet {

/// Returns the support. The names are the same with and without samples.
Json to_json(const std::optional<SupportReport>& support);

/// The block `domain`, including the support.
void list_fields(JsonFields& json, ZeroSetReport& report);
/// The block `cloud`.
/// @param h  edge length of the mesh, here and below
void list_fields(JsonFields& json, SampleDistances& distances, double h);
/// The block `triangles`.
void list_fields(JsonFields& json, TriangleDistances& distances);
/// The block `features`.
void list_fields(JsonFields& json, FeatureReport& report);
/// The block `resolution`.
void list_fields(JsonFields& json, ResolutionReport& report, double h);
/// The block `sizes`.
void list_fields(JsonFields& json, SizesReport& report);

}  // namespace umtet
