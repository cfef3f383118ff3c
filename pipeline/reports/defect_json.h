#pragma once

#include <vector>

#include "body/fidelity/closed_hole.h"
#include "body/fidelity/mesh_defect.h"
#include "body/fidelity/missed_place.h"
#include "pipeline/case/json_values.h"
#include "pipeline/case/thin_place_json.h"

// Defects, holes and missed places in documents, as JSON: a list with one object per element. The functions that read
// throw Json::exception if a value is missing. docs/reference.md explains the names.
namespace umtet {

Json to_json(const std::vector<ClosedHole>& holes);
std::vector<ClosedHole> closed_holes_from(const Json& list);

Json to_json(const std::vector<MissedPlace>& places);
std::vector<MissedPlace> missed_places_from(const Json& list);

/// Returns an object with the total number, the numbers by kind, and the list.
Json to_json(const DefectReport& report);
DefectReport defects_from(const Json& json);

}  // namespace umtet
