#pragma once

#include "pipeline/case/json_fields.h"
#include "pipeline/reports/certificate_report.h"

// Measurements of a mesh alone. docs/reference.md explains the names.
namespace umtet {

/// The counts, and the blocks `quality` and `boundary`.
/// @param coordinate_rounding_over_h  largest rounding error of a coordinate in the file, in h
void list_fields(JsonFields& json, MeshCertificate& certificate, double& coordinate_rounding_over_h);
/// Returns these blocks.
Json to_json(const MeshCertificate& certificate);

/// The block `second_order`.
void list_fields(JsonFields& json, SecondOrderReport& report);

}  // namespace umtet
