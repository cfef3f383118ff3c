#pragma once

#include "pipeline/case/json_fields.h"
#include "pipeline/reports/certificate_report.h"

// Certificates and records in JSON. They consist of the blocks of mesh_json.h, comparison_json.h and defect_json.h.
// Names are in the order of the documents. docs/reference.md explains them.
namespace umtet {

/// Returns the beginning of a document: its schema, the program and a version of it.
Json document_head(const std::string& version);

/// Returns `gates`, `verdict`, `accepted` and `reasons`.
Json to_json(const Verdict& verdict);

/// The block `measured` of the record of 3-mesh.
void list_fields(JsonFields& json, MeshMeasures& measured);
/// Returns the measurements with a verdict in place of the reasons: the output of `umtet evolve` for a step.
Json to_json(const MeshMeasures& measured, const Verdict& verdict);

/// Returns the contents of certificate.json.
Json to_json(const Certificate& certificate);
/// \throw ArtefactDamaged  a value is missing
Certificate certificate_from(const Json& json);

/// Returns the answer of `umtet check`.
Json to_json(const MeshCheck& check);

}  // namespace umtet
