#include "pipeline/reports/defect_json.h"

#include <string>

#include "pipeline/case/exit_code.h"

namespace umtet {
namespace {

void list_kind(JsonFields& json, DefectKind& kind) {
  std::string word = to_string(kind);
  json("kind", word);
  const std::optional<DefectKind> found = defect_kind_of(word);
  if (!found) throw ArtefactDamaged("'" + word + "' is not a kind of defect");
  kind = *found;
}

}  // namespace

void list_fields(JsonFields& json, MeshDefect& d) {
  list_kind(json, d.kind);
  json("where", d.where);
  json("off_over_h", d.off_over_h);
  json("size_over_h", d.size_over_h);
  json("feature_over_h", d.feature_over_h);
  json("h_needed", d.h_needed);
  json.derived("small", is_small(d));
  json("n", d.n);
}

void list_fields(JsonFields& json, DefectReport::OfKind& k) {
  list_kind(json, k.kind);
  json("n", k.n)("n_small", k.n_small)("max_off_over_h", k.max_off_over_h)("worst", k.worst);
}

void list_fields(JsonFields& json, DefectReport& report) {
  json.derived("n", report.n())("kinds", report.kinds)("listed", report.listed);
}

void list_fields(JsonFields& json, ClosedHole& hole) {
  json("centre", hole.centre);
  json("area", hole.area);
  json("area_fraction", hole.area_fraction);
  json("deepest", hole.deepest);
  json("deepest_over_spacing", hole.deepest_over_spacing);
  json.object(
      "rim", [&](JsonFields& rim) { rim("n", hole.n_rims)("length", hole.rim_length)("diameter", hole.rim_diameter); });
}

void list_fields(JsonFields& json, MissedPlace& p) {
  json("farthest", p.farthest)("distance", p.distance)("n_samples", p.n_samples);
}

}  // namespace umtet
