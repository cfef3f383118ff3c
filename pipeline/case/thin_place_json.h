#pragma once

#include <vector>

#include "body/thin_place.h"
#include "pipeline/case/json_values.h"

namespace umtet {

/// Returns a list with one object per thin place.
/// @param h  the edge length for which the places are too thin
Json to_json(const std::vector<ThinPlace>& places, double h);
std::vector<ThinPlace> thin_places_from(const Json& list);

}  // namespace umtet
