#include "pipeline/reports/defect_json.h"

#include <stdexcept>
#include <string>

#include "pipeline/case/exit_code.h"

namespace umtet {
namespace {

Json json_of_defect(const MeshDefect& defect) {
  return {{"kind", to_string(defect.kind)},
          {"where", json_of(defect.where)},
          {"off_over_h", defect.off_over_h},
          {"size_over_h", defect.size_over_h},
          {"feature_over_h", json_of(defect.feature_over_h)},
          {"h_needed", json_of(defect.h_needed)},
          {"small", is_small(defect)},
          {"n", defect.n}};
}

DefectKind kind_from(const Json& json) {
  const std::string word = json.at("kind");
  const std::optional<DefectKind> kind = defect_kind_of(word);
  if (!kind) throw ArtefactDamaged("'" + word + "' is not a kind of defect");
  return *kind;
}

MeshDefect defect_from(const Json& json) {
  return {.kind = kind_from(json),
          .where = vector_from(json.at("where")),
          .off_over_h = number_from(json.at("off_over_h")),
          .size_over_h = number_from(json.at("size_over_h")),
          .feature_over_h = optional_from<double>(json.at("feature_over_h")),
          .h_needed = optional_from<double>(json.at("h_needed")),
          .n = json.at("n")};
}

}  // namespace

Json to_json(const std::vector<ClosedHole>& holes) {
  Json list = Json::array();
  for (const ClosedHole& hole : holes) {
    list.push_back({{"centre", json_of(hole.centre)},
                    {"area", hole.area},
                    {"area_fraction", hole.area_fraction},
                    {"deepest", hole.deepest},
                    {"deepest_over_spacing", hole.deepest_over_spacing},
                    {"rim", {{"n", hole.n_rims}, {"length", hole.rim_length}, {"diameter", hole.rim_diameter}}}});
  }
  return list;
}

std::vector<ClosedHole> closed_holes_from(const Json& list) {
  std::vector<ClosedHole> holes;
  for (const Json& json : list) {
    const Json& rim = json.at("rim");
    holes.push_back({.centre = vector_from(json.at("centre")),
                     .area = number_from(json.at("area")),
                     .area_fraction = number_from(json.at("area_fraction")),
                     .deepest = number_from(json.at("deepest")),
                     .deepest_over_spacing = number_from(json.at("deepest_over_spacing")),
                     .rim_length = number_from(rim.at("length")),
                     .rim_diameter = number_from(rim.at("diameter")),
                     .n_rims = rim.at("n")});
  }
  return holes;
}

Json to_json(const std::vector<MissedPlace>& places) {
  Json list = Json::array();
  for (const MissedPlace& p : places) {
    list.push_back({{"farthest", json_of(p.farthest)}, {"distance", p.distance}, {"n_samples", p.n_samples}});
  }
  return list;
}

std::vector<MissedPlace> missed_places_from(const Json& list) {
  std::vector<MissedPlace> places;
  for (const Json& json : list) {
    places.push_back({.farthest = vector_from(json.at("farthest")),
                       .distance = number_from(json.at("distance")),
                       .n_samples = json.at("n_samples")});
  }
  return places;
}

Json to_json(const DefectReport& report) {
  Json kinds = Json::array(), list = Json::array();
  for (const DefectReport::OfKind& k : report.kinds) {
    kinds.push_back({{"kind", to_string(k.kind)},
                     {"n", k.n},
                     {"n_small", k.n_small},
                     {"max_off_over_h", k.max_off_over_h},
                     {"worst", json_of_defect(k.worst)}});
  }
  for (const MeshDefect& defect : report.listed) list.push_back(json_of_defect(defect));
  return {{"n", report.n()}, {"kinds", std::move(kinds)}, {"listed", std::move(list)}};
}

DefectReport defects_from(const Json& json) {
  DefectReport report;
  for (const Json& k : json.at("kinds")) {
    report.kinds.push_back({.kind = kind_from(k),
                            .n = k.at("n"),
                            .n_small = k.at("n_small"),
                            .worst = defect_from(k.at("worst")),
                            .max_off_over_h = number_from(k.at("max_off_over_h"))});
  }
  for (const Json& defect : json.at("listed")) report.listed.push_back(defect_from(defect));
  return report;
}

}  // namespace umtet
