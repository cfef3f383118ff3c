#pragma once

#include "pipeline/case/json_values.h"
#include "pipeline/reports/certificate_report.h"

// Certificates and records in JSON, of the blocks of mesh_json.h, comparison_json.h and place_json.h. The order of the
// names is that of the documents. docs/reference.md says what they mean.
namespace umtet {

/// What a document of ours begins with: its schema, the program and a version of it.
Json document_head(const std::string& version);

/// `gates`, `verdict`, `accepted` and `reasons`.
Json to_json(const Verdict& verdict);

/// The block `measured` of the record of 3-mesh.
Json to_json(const MeshMeasures& measured);
/// \throw Json::exception  something is missing
MeshMeasures measures_from(const Json& json);
/// The same with a verdict in place of the reasons: what `umtet evolve` says of a step.
Json to_json(const MeshMeasures& measured, const Verdict& verdict);

/// certificate.json.
Json to_json(const Certificate& certificate);
/// \throw ArtefactDamaged  something is missing
Certificate certificate_from(const Json& json);

/// What `umtet check` answers.
Json to_json(const MeshCheck& check);

}  // namespace umtet
