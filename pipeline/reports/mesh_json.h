#pragma once

#include "pipeline/case/json_values.h"
#include "pipeline/reports/certificate_report.h"

// Measurements of a mesh alone, as JSON. The functions that read throw Json::exception if a value is missing.
// docs/reference.md explains the names.
namespace umtet {

/// Returns the counts, and the blocks `quality` and `boundary`.
Json to_json(const MeshCertificate& certificate);
/// Returns these blocks for a mesh from a file.
/// @param coordinate_rounding_over_h  largest rounding error of a coordinate in the file, in h
Json mesh_blocks(const MeshCertificate& certificate, double coordinate_rounding_over_h);
MeshCertificate mesh_from(const Json& json);

/// Returns the block `second_order`.
Json to_json(const SecondOrderReport& report);
SecondOrderReport second_order_from(const Json& json);

}  // namespace umtet
