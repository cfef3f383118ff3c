#pragma once

#include <optional>

#include "pipeline/case/json_values.h"
#include "pipeline/reports/certificate_report.h"

// How a mesh compares with psi = 0, samples, triangles and the sizes that were asked for, as JSON. What reads it throws
// Json::exception where something is missing. docs/reference.md says what the names mean.
namespace umtet {

/// The same names with and without samples.
Json to_json(const std::optional<SupportReport>& support);

/// The block `domain`, with the names of the support.
Json to_json(const ZeroSetReport& report);
ZeroSetReport zero_set_from(const Json& json);

/// The block `cloud`.
/// @param h  of the mesh, here and below
Json to_json(const SampleDistances& distances, double h);
SampleDistances distances_from(const Json& json);

/// The block `triangles`.
Json to_json(const TriangleDistances& distances);
TriangleDistances triangle_distances_from(const Json& json);

/// The block `resolution`.
Json to_json(const ResolutionReport& report, double h);
ResolutionReport resolution_from(const Json& json);

/// The block `sizes`.
Json to_json(const SizesReport& report);
SizesReport sizes_from(const Json& json);

}  // namespace umtet
