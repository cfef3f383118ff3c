#pragma once

#include <optional>

#include "pipeline/case/json_values.h"
#include "pipeline/reports/certificate_report.h"

// Comparison of a mesh with psi = 0, samples, triangles and requested sizes, as JSON. The functions that read throw
// Json::exception if a value is missing. docs/reference.md explains the names.
namespace umtet {

/// Returns the support. The names are the same with and without samples.
Json to_json(const std::optional<SupportReport>& support);

/// Returns the block `domain`, including the support.
Json to_json(const ZeroSetReport& report);
ZeroSetReport zero_set_from(const Json& json);

/// Returns the block `cloud`.
/// @param h  edge length of the mesh, here and below
Json to_json(const SampleDistances& distances, double h);
SampleDistances distances_from(const Json& json);

/// Returns the block `triangles`.
Json to_json(const TriangleDistances& distances);
TriangleDistances triangle_distances_from(const Json& json);

/// Returns the block `features`.
Json to_json(const FeatureReport& report);
FeatureReport features_from(const Json& json);

/// Returns the block `resolution`.
Json to_json(const ResolutionReport& report, double h);
ResolutionReport resolution_from(const Json& json);

/// Returns the block `sizes`.
Json to_json(const SizesReport& report);
SizesReport sizes_from(const Json& json);

}  // namespace umtet
