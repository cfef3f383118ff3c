#include "pipeline/reports/comparison_json.h"

#include <array>
#include <string>

#include "pipeline/reports/defect_json.h"

namespace umtet {
namespace {

Json ratio_to(double h, const std::optional<double>& length) { return length ? Json(*length / h) : Json(nullptr); }

std::optional<SupportReport> support_from(const Json& json) {
  if (json.at("unsupported_area_fraction").is_null()) return std::nullopt;
  SupportReport support;
  support.unsupported_area_fraction = number_from(json.at("unsupported_area_fraction"));
  support.radius = number_from(json.at("support_radius"));
  support.n_closed_holes = json.at("n_closed_holes");
  support.n_guessed_handles = json.at("n_guessed_handles");
  support.n_guessed_pieces = json.at("n_guessed_pieces");
  support.closed_holes = closed_holes_from(json.at("closed_holes"));
  return support;
}

constexpr std::array<const char*, 3> kTopologyWords = {"same", "differs", "not proved"};

const char* word_of(TopologyProof proof) { return kTopologyWords.at(static_cast<std::size_t>(proof)); }

TopologyProof topology_of(const std::string& word) {
  for (const TopologyProof proof : {TopologyProof::Same, TopologyProof::Differs}) {
    if (word == word_of(proof)) return proof;
  }
  return TopologyProof::NotProved;
}

}  // namespace

Json to_json(const std::optional<SupportReport>& support) {
  if (!support) {
    return {{"unsupported_area_fraction", nullptr}, {"support_radius", nullptr},   {"n_closed_holes", nullptr},
            {"n_guessed_handles", nullptr},         {"n_guessed_pieces", nullptr}, {"closed_holes", nullptr}};
  }
  return {{"unsupported_area_fraction", support->unsupported_area_fraction},
          {"support_radius", support->radius},
          {"n_closed_holes", support->n_closed_holes},
          {"n_guessed_handles", support->n_guessed_handles},
          {"n_guessed_pieces", support->n_guessed_pieces},
          {"closed_holes", to_json(support->closed_holes)}};
}

Json to_json(const ZeroSetReport& r) {
  Json json = {{"level_set_spacing", json_of(r.level_set_spacing)},
               {"components_of_zero_set", r.components_of_zero_set},
               {"euler_characteristic_of_zero_set", r.euler_characteristic_of_zero_set},
               {"components_kept", r.components_kept},
               {"euler_characteristic_of_kept_components", r.euler_characteristic_of_kept_components},
               {"components_meshed", r.components_meshed},
               {"euler_characteristic_meshed", r.euler_characteristic_meshed},
               {"counting_spacing", r.counting_spacing},
               {"topology", word_of(r.topology)},
               {"topology_at", r.topology_at ? json_of(*r.topology_at) : Json(nullptr)},
               {"components_dropped", r.components_dropped},
               {"components_proved", json_of(r.components_proved)}};
  if (r.level_shift != 0) json["level_shift"] = r.level_shift;
  json.update(to_json(r.support));
  return json;
}

ZeroSetReport zero_set_from(const Json& json) {
  const Json& at = json.at("topology_at");
  return {.level_set_spacing = optional_from<double>(json.at("level_set_spacing")),
          .components_of_zero_set = json.at("components_of_zero_set"),
          .euler_characteristic_of_zero_set = json.at("euler_characteristic_of_zero_set"),
          .euler_characteristic_of_kept_components = json.at("euler_characteristic_of_kept_components"),
          .components_kept = json.at("components_kept"),
          .components_meshed = json.at("components_meshed"),
          .euler_characteristic_meshed = json.at("euler_characteristic_meshed"),
          .counting_spacing = number_from(json.at("counting_spacing")),
          .topology = topology_of(json.at("topology")),
          .topology_at = at.is_null() ? std::nullopt : std::optional(vector_from(at)),
          .components_dropped = json.at("components_dropped"),
          .components_proved = optional_from<bool>(json.at("components_proved")),
          .support = support_from(json),
          .level_shift = json.value("level_shift", 0.)};
}

Json to_json(const SampleDistances& d, double h) {
  Json json = {{"noise", json_of(d.noise)},
               {"noise_over_h", ratio_to(h, d.noise)},
               {"rms_distance", d.rms},
               {"max_distance", d.max},
               {"p99_distance", d.p99},
               {"rms_distance_over_h", d.rms / h},
               {"max_distance_over_h", d.max / h},
               {"p99_distance_over_h", d.p99 / h},
               {"missed_beyond", d.missed_beyond},
               {"n_beyond_h", d.n_beyond_h},
               {"most_over_h", d.most_over_h},
               {"most_at", json_of(d.most_at)},
               {"n_missed_places", d.n_missed_places},
               {"missed_places", to_json(d.missed)}};
  if (d.n_merged) json["n_merged"] = *d.n_merged;
  return json;
}

SampleDistances distances_from(const Json& json) {
  SampleDistances d{.noise = optional_from<double>(json.at("noise")),
                    .rms = number_from(json.at("rms_distance")),
                    .max = number_from(json.at("max_distance")),
                    .p99 = number_from(json.at("p99_distance"))};
  if (json.contains("n_merged")) d.n_merged = json.at("n_merged");
  d.missed_beyond = number_from(json.at("missed_beyond"));
  d.n_beyond_h = json.at("n_beyond_h");
  d.most_over_h = number_from(json.at("most_over_h"));
  d.most_at = vector_from(json.at("most_at"));
  d.n_missed_places = json.at("n_missed_places");
  d.missed = missed_places_from(json.at("missed_places"));
  return d;
}

namespace {

Json to_json(const TriangleBody& b) {
  return {{"volume", b.volume},       {"area", b.area},
          {"pieces", b.n_pieces},     {"euler_characteristic", b.euler_characteristic},
          {"genus", b.genus()},       {"closed", b.is_closed},
          {"manifold", b.is_manifold}};
}

TriangleBody triangle_body_from(const Json& json) {
  return {.volume = number_from(json.at("volume")),
          .area = number_from(json.at("area")),
          .n_pieces = json.at("pieces"),
          .euler_characteristic = json.at("euler_characteristic"),
          .is_closed = json.at("closed"),
          .is_manifold = json.at("manifold")};
}

}  // namespace

Json to_json(const TriangleDistances& d) {
  Json json = {{"n_triangles", d.n_triangles},
               {"rms_distance", d.rms},
               {"p99_distance", d.p99},
               {"max_distance", d.max},
               {"max_distance_over_h", d.max_over_h},
               {"farthest", json_of(d.farthest)},
               {"rms_distance_back", d.rms_back},
               {"p99_distance_back", d.p99_back},
               {"max_distance_back", d.max_back},
               {"max_distance_back_over_h", d.max_back_over_h},
               {"farthest_back", json_of(d.farthest_back)}};
  if (const std::optional<SharpEdgeReport>& e = d.edges) {
    json["edges"] = {{"curves", e->n_curves},
                     {"corners", e->n_corners},
                     {"patches", e->n_patches},
                     {"length", e->length},
                     {"rounded_length", e->rounded_length},
                     {"max_distance_over_h", e->max_over_h},
                     {"farthest", json_of(e->farthest)}};
  }
  if (!d.body) return json;
  json["body"] = to_json(*d.body);
  json["mesh"] = to_json(d.mesh);
  return json;
}

TriangleDistances triangle_distances_from(const Json& json) {
  TriangleDistances d{.n_triangles = json.at("n_triangles"),
                      .rms = number_from(json.at("rms_distance")),
                      .p99 = number_from(json.at("p99_distance")),
                      .max = number_from(json.at("max_distance")),
                      .max_over_h = number_from(json.at("max_distance_over_h")),
                      .farthest = vector_from(json.at("farthest")),
                      .rms_back = number_from(json.at("rms_distance_back")),
                      .p99_back = number_from(json.at("p99_distance_back")),
                      .max_back = number_from(json.at("max_distance_back")),
                      .max_back_over_h = number_from(json.at("max_distance_back_over_h")),
                      .farthest_back = vector_from(json.at("farthest_back"))};
  if (json.contains("edges")) {
    const Json& e = json.at("edges");
    d.edges = {.n_curves = e.at("curves"),
               .n_corners = e.at("corners"),
               .n_patches = e.at("patches"),
               .length = number_from(e.at("length")),
               .rounded_length = number_from(e.at("rounded_length")),
               .max_over_h = number_from(e.at("max_distance_over_h")),
               .farthest = vector_from(e.at("farthest"))};
  }
  if (!json.contains("body")) return d;
  d.body = triangle_body_from(json.at("body"));
  d.mesh = triangle_body_from(json.at("mesh"));
  return d;
}

Json to_json(const FeatureReport& f) {
  return {{"patches", f.n_patches},
          {"corners", f.n_corners},
          {"curves", f.n_curves},
          {"missed_corners", f.n_missed_corners},
          {"missed_curves", f.n_missed_curves},
          {"length", f.length},
          {"missed_length", f.missed_length},
          {"max_vertex_distance_over_h", f.max_vertex_over_h},
          {"max_curve_distance_over_h", f.max_curve_over_h},
          {"max_angle_off_deg", f.max_angle_off_deg},
          {"min_angle_deg", f.min_angle_deg},
          {"wedge_quality", f.wedge_quality},
          {"min_cos_normal", f.min_cos_normal},
          {"faces_without_patch", f.n_faces_without_patch}};
}

FeatureReport features_from(const Json& json) {
  return {.n_patches = json.at("patches"),
          .n_corners = json.at("corners"),
          .n_curves = json.at("curves"),
          .n_missed_corners = json.at("missed_corners"),
          .n_missed_curves = json.at("missed_curves"),
          .length = number_from(json.at("length")),
          .missed_length = number_from(json.at("missed_length")),
          .max_vertex_over_h = number_from(json.at("max_vertex_distance_over_h")),
          .max_curve_over_h = number_from(json.at("max_curve_distance_over_h")),
          .max_angle_off_deg = number_from(json.at("max_angle_off_deg")),
          .min_angle_deg = number_from(json.at("min_angle_deg")),
          .wedge_quality = number_from(json.at("wedge_quality")),
          .min_cos_normal = number_from(json.at("min_cos_normal")),
          .n_faces_without_patch = json.at("faces_without_patch")};
}

Json to_json(const ResolutionReport& r, double h) {
  Json json = {{"kappa_h_max", r.kappa_h_max},
               {"feature_size_over_h_min", r.feature_size_over_h_min},
               {"obtuse_conditioning_angles", r.obtuse_conditioning_angles},
               {"double_positive_faces", r.double_positive_faces}};
  if (r.too_thin) json["too_thin"] = to_json(*r.too_thin, h);
  return json;
}

ResolutionReport resolution_from(const Json& json) {
  ResolutionReport r{.kappa_h_max = number_from(json.at("kappa_h_max")),
                     .feature_size_over_h_min = number_from(json.at("feature_size_over_h_min")),
                     .obtuse_conditioning_angles = json.at("obtuse_conditioning_angles"),
                     .double_positive_faces = json.at("double_positive_faces"),
                     .too_thin = {}};
  if (json.contains("too_thin")) r.too_thin = thin_places_from(json.at("too_thin"));
  return r;
}

Json to_json(const SizesReport& s) {
  return {{"least_asked", s.least_asked},
          {"greatest_asked", s.greatest_asked},
          {"edge_over_asked", {{"p01", s.p01}, {"p50", s.p50}, {"p99", s.p99}}},
          {"shortest_boundary_edge", s.shortest_boundary_edge},
          {"longest_boundary_edge", s.longest_boundary_edge}};
}

SizesReport sizes_from(const Json& json) {
  const Json& ratio = json.at("edge_over_asked");
  return {.least_asked = number_from(json.at("least_asked")),
          .greatest_asked = number_from(json.at("greatest_asked")),
          .p01 = number_from(ratio.at("p01")),
          .p50 = number_from(ratio.at("p50")),
          .p99 = number_from(ratio.at("p99")),
          .shortest_boundary_edge = number_from(json.at("shortest_boundary_edge")),
          .longest_boundary_edge = number_from(json.at("longest_boundary_edge"))};
}

}  // namespace umtet
