#include "pipeline/case/thin_place_json.h"

namespace umtet {

void list_fields(JsonFields& json, ThinPlace& p, double h) {
  json.word("kind", p.is_gap, std::array{"body", "gap"})("centre", p.centre)
      .object("box", [&](JsonFields& box) { box("min", p.box.min())("max", p.box.max()); })("thickness", p.thickness)
      .derived("thickness_over_h", p.thickness / h)("area", p.area)("h_needed", p.h_needed);
}

Json to_json(const std::vector<ThinPlace>& places, double h) {
  Json list = Json::array();
  for (const ThinPlace& place : places) list.push_back(json_by_fields(place, h));
  return list;
}

}  // namespace umtet
