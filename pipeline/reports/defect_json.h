#pragma once

#include "body/fidelity/closed_hole.h"
#include "body/fidelity/mesh_defect.h"
#include "body/fidelity/missed_place.h"
#include "pipeline/case/json_fields.h"

// Defects, holes and missed places in documents. docs/reference.md explains the names.
namespace umtet {

void list_fields(JsonFields& json, ClosedHole& hole);
void list_fields(JsonFields& json, MissedPlace& place);
void list_fields(JsonFields& json, DefectReport& report);

}  // namespace umtet
