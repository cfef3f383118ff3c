#pragma once

#include "pipeline/case/json_values.h"
#include "pipeline/reports/certificate_report.h"

// What is true of a mesh by itself, as JSON. What reads it throws Json::exception where something is missing.
// docs/reference.md says what the names mean.
namespace umtet {

/// The counts, the blocks `quality` and `boundary`.
Json to_json(const MeshCertificate& certificate);
/// The same for a mesh of a file that rounds coordinates by so much.
Json mesh_blocks(const MeshCertificate& certificate, double coordinate_rounding_over_h);
MeshCertificate mesh_from(const Json& json);

/// The block `second_order`.
Json to_json(const SecondOrderReport& report);
SecondOrderReport second_order_from(const Json& json);

}  // namespace umtet
