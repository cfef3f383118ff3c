#pragma once

#include <vector>

#include "body/fidelity/closed_hole.h"
#include "body/fidelity/mesh_place.h"
#include "body/fidelity/missed_place.h"
#include "pipeline/case/json_values.h"
#include "pipeline/case/thin_place_json.h"

// The places that documents list, as JSON: a list, an object a place. What reads them throws Json::exception where
// something is missing. docs/reference.md says what the names mean.
namespace umtet {

Json to_json(const std::vector<ClosedHole>& holes);
std::vector<ClosedHole> closed_holes_from(const Json& list);

Json to_json(const std::vector<MissedPlace>& places);
std::vector<MissedPlace> missed_places_from(const Json& list);

/// An object: the number of all, what there is of each kind, and the list.
Json to_json(const PlaceReport& report);
PlaceReport places_from(const Json& json);

}  // namespace umtet
