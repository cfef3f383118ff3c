#pragma once

#include <vector>

#include "body/thin_place.h"
#include "pipeline/case/json_fields.h"

namespace umtet {

/// @param h  the edge length for which the place is too thin
void list_fields(JsonFields& json, ThinPlace& place, double h);
/// Returns a list with one object per place.
Json to_json(const std::vector<ThinPlace>& places, double h);

}  // namespace umtet
