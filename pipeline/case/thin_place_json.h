#pragma once

#include <vector>

#include "body/thin_place.h"
#include "pipeline/case/json_values.h"

namespace umtet {

/// A list, an object a place.
/// @param h  the edge length that the places are too thin for
Json to_json(const std::vector<ThinPlace>& places, double h);
std::vector<ThinPlace> thin_places_from(const Json& list);

}  // namespace umtet
