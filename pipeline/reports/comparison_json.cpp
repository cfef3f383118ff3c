#include "pipeline/reports/comparison_json.h"

#include <array>

#include "pipeline/case/thin_place_json.h"
#include "pipeline/reports/defect_json.h"

namespace umtet {

void list_fields(JsonFields& json, SupportReport& s) {
  json("unsupported_area_fraction", s.unsupported_area_fraction);
  json("support_radius", s.radius);
  json("n_closed_holes", s.n_closed_holes);
  json("n_guessed_handles", s.n_guessed_handles);
  json("n_guessed_pieces", s.n_guessed_pieces);
  json("closed_holes", s.closed_holes);
}

Json to_json(const std::optional<SupportReport>& support) {
  Json json = json_by_fields(support.value_or(SupportReport{}));
  if (!support)
    for (Json& value : json) value = nullptr;
  return json;
}

void list_fields(JsonFields& json, ZeroSetReport& r) {
  json("level_set_spacing", r.level_set_spacing);
  json("components_of_zero_set", r.components_of_zero_set);
  json("euler_characteristic_of_zero_set", r.euler_characteristic_of_zero_set);
  json("components_kept", r.components_kept);
  json("euler_characteristic_of_kept_components", r.euler_characteristic_of_kept_components);
  json("components_meshed", r.components_meshed);
  json("euler_characteristic_meshed", r.euler_characteristic_meshed);
  json("counting_spacing", r.counting_spacing);
  json.word("topology", r.topology, std::array{"same", "differs", "not proved"});
  json("topology_at", r.topology_at);
  json("components_dropped", r.components_dropped);
  json("components_proved", r.components_proved);
  json.if_any("level_shift", r.level_shift);
  if (json.is_reading()) {
    std::optional<double> fraction;
    json("unsupported_area_fraction", fraction);
    if (fraction) list_fields(json, r.support.emplace());
  } else {
    const Json support = to_json(r.support);
    for (const auto& [name, value] : support.items()) json.derived(name, value);
  }
}

void list_fields(JsonFields& json, SampleDistances& d, double h) {
  json("noise", d.noise);
  json.derived("noise_over_h", d.noise ? Json(*d.noise / h) : Json(nullptr));
  json("rms_distance", d.rms)("max_distance", d.max)("p99_distance", d.p99);
  json.derived("rms_distance_over_h", d.rms / h).derived("max_distance_over_h", d.max / h);
  json.derived("p99_distance_over_h", d.p99 / h);
  json("missed_beyond", d.missed_beyond);
  json("n_beyond_h", d.n_beyond_h);
  json("most_over_h", d.most_over_h);
  json("most_at", d.most_at);
  json("n_missed_places", d.n_missed_places);
  json("missed_places", d.missed);
  json.if_any("n_merged", d.n_merged);
}

void list_fields(JsonFields& json, TriangleBody& b) {
  json("volume", b.volume)("area", b.area)("pieces", b.n_pieces)("euler_characteristic", b.euler_characteristic);
  json.derived("genus", b.genus())("closed", b.is_closed)("manifold", b.is_manifold);
}

void list_fields(JsonFields& json, SharpEdgeReport& e) {
  json("curves", e.n_curves)("corners", e.n_corners)("patches", e.n_patches)("length", e.length);
  json("rounded_length", e.rounded_length)("max_distance_over_h", e.max_over_h)("farthest", e.farthest);
}

void list_fields(JsonFields& json, TriangleDistances& d) {
  json("n_triangles", d.n_triangles);
  json("rms_distance", d.rms)("p99_distance", d.p99)("max_distance", d.max);
  json("max_distance_over_h", d.max_over_h)("farthest", d.farthest);
  json("rms_distance_back", d.rms_back)("p99_distance_back", d.p99_back)("max_distance_back", d.max_back);
  json("max_distance_back_over_h", d.max_back_over_h)("farthest_back", d.farthest_back);
  json.if_any("edges", d.edges);
  json.if_any("body", d.body);
  if (d.body) json("mesh", d.mesh);
}

void list_fields(JsonFields& json, FeatureReport& f) {
  json("patches", f.n_patches)("corners", f.n_corners)("curves", f.n_curves);
  json("missed_corners", f.n_missed_corners)("missed_curves", f.n_missed_curves);
  json("length", f.length)("missed_length", f.missed_length);
  json("max_vertex_distance_over_h", f.max_vertex_over_h);
  json("max_curve_distance_over_h", f.max_curve_over_h);
  json("max_angle_off_deg", f.max_angle_off_deg);
  json("min_angle_deg", f.min_angle_deg);
  json("wedge_quality", f.wedge_quality);
  json("min_cos_normal", f.min_cos_normal);
  json("faces_without_patch", f.n_faces_without_patch);
}

void list_fields(JsonFields& json, ResolutionReport& r, double h) {
  json("kappa_h_max", r.kappa_h_max);
  json("feature_size_over_h_min", r.feature_size_over_h_min);
  json("obtuse_conditioning_angles", r.obtuse_conditioning_angles);
  json("double_positive_faces", r.double_positive_faces);
  json.if_any("too_thin", r.too_thin, h);
}

void list_fields(JsonFields& json, SizesReport& s) {
  json("least_asked", s.least_asked)("greatest_asked", s.greatest_asked);
  json.object("edge_over_asked", [&](JsonFields& ratio) { ratio("p01", s.p01)("p50", s.p50)("p99", s.p99); });
  json("shortest_boundary_edge", s.shortest_boundary_edge)("longest_boundary_edge", s.longest_boundary_edge);
}

}  // namespace umtet
