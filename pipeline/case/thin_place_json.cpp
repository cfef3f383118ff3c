#include "pipeline/case/thin_place_json.h"

namespace umtet {

Json to_json(const std::vector<ThinPlace>& places, double h) {
  Json list = Json::array();
  for (const ThinPlace& p : places) {
    list.push_back({{"kind", p.is_gap ? "gap" : "body"},
                    {"centre", json_of(p.centre)},
                    {"box", {{"min", json_of(Vec3(p.box.min()))}, {"max", json_of(Vec3(p.box.max()))}}},
                    {"thickness", p.thickness},
                    {"thickness_over_h", p.thickness / h},
                    {"area", p.area},
                    {"h_needed", p.h_needed}});
  }
  return list;
}

std::vector<ThinPlace> thin_places_from(const Json& list) {
  std::vector<ThinPlace> places;
  for (const Json& json : list) {
    const Json& box = json.at("box");
    places.push_back({.is_gap = json.at("kind") == "gap",
                      .box = {vector_from(box.at("min")), vector_from(box.at("max"))},
                      .centre = vector_from(json.at("centre")),
                      .thickness = number_from(json.at("thickness")),
                      .area = number_from(json.at("area")),
                      .h_needed = number_from(json.at("h_needed"))});
  }
  return places;
}

}  // namespace umtet
