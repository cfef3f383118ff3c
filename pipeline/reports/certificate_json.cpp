#include "pipeline/reports/certificate_json.h"

#include <array>

#include "pipeline/case/exit_code.h"
#include "pipeline/reports/place_json.h"

namespace umtet {
namespace {

constexpr int kSchema = 1;

Json ratio_to(double h, const std::optional<double>& length) { return length ? Json(*length / h) : Json(nullptr); }

Json mesh_blocks(const MeshCertificate& c, double coordinate_rounding_over_h) {
  const MeshCertificate::Boundary& b = c.boundary;
  return {{"n_tets", c.n_tets},
          {"n_vertices", c.n_vertices},
          {"n_positive_faces", b.equals_positive_faces ? Json(c.n_positive_faces) : Json(nullptr)},
          {"n_wall_faces", c.n_wall_faces},
          {"h", c.h},
          {"volume", c.volume},
          {"quality",
           {{"min", c.quality.min},
            {"p001", c.quality.p001},
            {"p01", c.quality.p01},
            {"mean", c.quality.mean},
            {"dihedral_min_deg", c.quality.dihedral_min_deg},
            {"dihedral_max_deg", c.quality.dihedral_max_deg},
            {"n_inverted", c.quality.n_inverted}}},
          {"boundary",
           {{"closed_manifold", b.closed_manifold},
            {"self_intersections", b.n_self_intersections},
            {"wrongly_nested", b.n_wrongly_nested},
            {"embedded", c.is_embedded()},
            {"equals_positive_faces", json_of(b.equals_positive_faces)},
            {"components", b.components},
            {"euler_characteristic", b.euler_characteristic},
            {"genus", b.genus},
            {"n_faces", b.n_faces},
            {"area", b.area},
            {"max_vertex_distance_over_h", json_of(b.max_vertex_distance_over_h)},
            {"coordinate_rounding_over_h", coordinate_rounding_over_h},
            {"max_centroid_distance_over_h", json_of(b.max_centroid_distance_over_h)},
            {"min_cos_normal", json_of(b.min_cos_normal)},
            {"gap_over_volume", json_of(b.gap_over_volume)},
            {"n_cos_below_half", b.n_cos_below_half}}}};
}

MeshCertificate mesh_from(const Json& json) {
  MeshCertificate c;
  c.n_tets = json.at("n_tets");
  c.n_vertices = json.at("n_vertices");
  c.n_positive_faces = optional_from<std::size_t>(json.at("n_positive_faces")).value_or(0);
  c.n_wall_faces = json.at("n_wall_faces");
  c.h = number_from(json.at("h"));
  c.volume = number_from(json.at("volume"));
  const Json& quality = json.at("quality");
  c.quality = {.min = number_from(quality.at("min")),
               .p001 = number_from(quality.at("p001")),
               .p01 = number_from(quality.at("p01")),
               .mean = number_from(quality.at("mean")),
               .dihedral_min_deg = number_from(quality.at("dihedral_min_deg")),
               .dihedral_max_deg = number_from(quality.at("dihedral_max_deg")),
               .n_inverted = quality.at("n_inverted")};
  const Json& boundary = json.at("boundary");
  MeshCertificate::Boundary& b = c.boundary;
  b.closed_manifold = boundary.at("closed_manifold");
  b.n_self_intersections = boundary.at("self_intersections");
  b.n_wrongly_nested = boundary.at("wrongly_nested");
  b.equals_positive_faces = optional_from<bool>(boundary.at("equals_positive_faces"));
  b.components = boundary.at("components");
  b.euler_characteristic = boundary.at("euler_characteristic");
  b.genus = boundary.at("genus");
  b.n_faces = boundary.at("n_faces");
  b.area = number_from(boundary.at("area"));
  b.max_vertex_distance_over_h = optional_from<double>(boundary.at("max_vertex_distance_over_h"));
  b.max_centroid_distance_over_h = optional_from<double>(boundary.at("max_centroid_distance_over_h"));
  b.min_cos_normal = optional_from<double>(boundary.at("min_cos_normal"));
  b.gap_over_volume = optional_from<double>(boundary.at("gap_over_volume"));
  b.n_cos_below_half = boundary.at("n_cos_below_half");
  return c;
}

/// The same keys with and without a cloud.
Json to_json(const std::optional<SupportReport>& support) {
  if (!support) {
    return {{"unsupported_area_fraction", nullptr},
            {"support_radius", nullptr},
            {"n_closed_holes", nullptr},
            {"closed_holes", nullptr}};
  }
  return {{"unsupported_area_fraction", support->unsupported_area_fraction},
          {"support_radius", support->radius},
          {"n_closed_holes", support->n_closed_holes},
          {"closed_holes", to_json(support->closed_holes)}};
}

std::optional<SupportReport> support_from(const Json& json) {
  if (json.at("unsupported_area_fraction").is_null()) return std::nullopt;
  SupportReport support;
  support.unsupported_area_fraction = number_from(json.at("unsupported_area_fraction"));
  if (!json.contains("support_radius")) return support;  // written before holes were looked for: there are none
  support.radius = number_from(json.at("support_radius"));
  support.n_closed_holes = json.at("n_closed_holes");
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
          .support = support_from(json)};
}

Json to_json(const SampleDistances& d, double h) {
  return {{"noise", json_of(d.noise)},
          {"noise_over_h", ratio_to(h, d.noise)},
          {"rms_distance", d.rms},
          {"max_distance", d.max},
          {"p99_distance", d.p99},
          {"rms_distance_over_h", d.rms / h},
          {"max_distance_over_h", d.max / h},
          {"p99_distance_over_h", d.p99 / h},
          {"missed_beyond", d.missed_beyond},
          {"n_missed_places", d.n_missed_places},
          {"missed_places", to_json(d.missed)}};
}

SampleDistances distances_from(const Json& json) {
  SampleDistances d{.noise = optional_from<double>(json.at("noise")),
                    .rms = number_from(json.at("rms_distance")),
                    .max = number_from(json.at("max_distance")),
                    .p99 = number_from(json.at("p99_distance"))};
  if (!json.contains("missed_beyond")) return d;  // written before they were looked for
  d.missed_beyond = number_from(json.at("missed_beyond"));
  d.n_missed_places = json.at("n_missed_places");
  d.missed = missed_places_from(json.at("missed_places"));
  return d;
}

Json to_json(const TriangleDistances& d, double h) {
  return {{"n_triangles", d.n_triangles},
          {"rms_distance", d.rms},
          {"p99_distance", d.p99},
          {"max_distance", d.max},
          {"max_distance_over_h", d.max / h},
          {"farthest", json_of(d.farthest)},
          {"rms_distance_back", d.rms_back},
          {"p99_distance_back", d.p99_back},
          {"max_distance_back", d.max_back},
          {"max_distance_back_over_h", d.max_back / h},
          {"farthest_back", json_of(d.farthest_back)}};
}

TriangleDistances triangle_distances_from(const Json& json) {
  return {.n_triangles = json.at("n_triangles"),
          .rms = number_from(json.at("rms_distance")),
          .p99 = number_from(json.at("p99_distance")),
          .max = number_from(json.at("max_distance")),
          .farthest = vector_from(json.at("farthest")),
          .rms_back = number_from(json.at("rms_distance_back")),
          .p99_back = number_from(json.at("p99_distance_back")),
          .max_back = number_from(json.at("max_distance_back")),
          .farthest_back = vector_from(json.at("farthest_back"))};
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

SecondOrderReport second_order_from(const Json& json) {
  SecondOrderReport r;
  SecondOrderCertificate& c = r.certificate;
  c.n_nodes = json.at("n_nodes");
  c.volume = number_from(json.at("volume"));
  c.min_scaled_jacobian_lower = number_from(json.at("min_scaled_jacobian"));
  c.min_scaled_jacobian_upper = number_from(json.at("min_scaled_jacobian_upper"));
  c.n_nonpositive_jacobians = json.at("n_nonpositive_jacobians");
  c.n_torn_edges = json.at("n_torn_edges");
  c.n_boundary_mid_sides = json.at("n_boundary_mid_sides");
  c.n_mid_sides_off_surface = json.at("n_mid_sides_off_surface");
  c.max_mid_side_distance_over_h = optional_from<double>(json.at("max_mid_side_distance_over_h"));
  c.max_face_distance_over_h = optional_from<double>(json.at("max_face_distance_over_h"));
  c.rms_face_distance_over_h = optional_from<double>(json.at("rms_face_distance_over_h"));
  if (!json.contains("n_mid_sides_put_back")) return r;
  r.repairs = {.n_mid_sides_put_back = json.at("n_mid_sides_put_back"),
               .n_mid_sides_unprojected = json.at("n_mid_sides_unprojected"),
               .n_mid_sides_slid = json.at("n_mid_sides_slid"),
               .n_mid_sides_relaxed = json.at("n_mid_sides_relaxed")};
  return r;
}

Json second_order_block(const std::optional<SecondOrderReport>& second) {
  return second ? to_json(*second) : Json(nullptr);
}

/// All that is measured up to the resolution.
Json measured_blocks(const MeshMeasures& m) {
  Json json = {{"n_points", json_of(m.n_points)}};
  json.update(mesh_blocks(m.mesh, m.coordinate_rounding_over_h));
  json["domain"] = to_json(m.domain);
  json["cloud"] = m.cloud ? to_json(*m.cloud, m.mesh.h) : Json(nullptr);
  if (m.triangles) json["triangles"] = to_json(*m.triangles, m.mesh.h);
  json["resolution"] = to_json(m.resolution, m.mesh.h);
  if (m.sizes) json["sizes"] = to_json(*m.sizes);
  json["valid"] = m.is_valid;
  json["faithful"] = m.is_faithful;
  json["places"] = to_json(m.places);
  return json;
}

void add_order(const MeshMeasures& m, Json& json) {
  if (!m.order) return;
  json["order"] = *m.order;
  json["second_order"] = second_order_block(m.second_order);
}

/// All that is measured but the reasons.
MeshMeasures measured_blocks_from(const Json& json) {
  MeshMeasures m;
  m.n_points = optional_from<std::size_t>(json.at("n_points"));
  m.mesh = mesh_from(json);
  m.coordinate_rounding_over_h = number_from(json.at("boundary").at("coordinate_rounding_over_h"));
  m.domain = zero_set_from(json.at("domain"));
  if (!json.at("cloud").is_null()) m.cloud = distances_from(json.at("cloud"));
  if (json.contains("triangles")) m.triangles = triangle_distances_from(json.at("triangles"));
  m.resolution = resolution_from(json.at("resolution"));
  if (json.contains("sizes")) m.sizes = sizes_from(json.at("sizes"));
  m.is_valid = json.at("valid");
  m.is_faithful = json.at("faithful");
  m.places = places_from(json.at("places"));
  if (!json.contains("order")) return m;
  m.order = json.at("order");
  if (!json.at("second_order").is_null()) m.second_order = second_order_from(json.at("second_order"));
  return m;
}

Verdict verdict_from(const Json& json) {
  const Json& gates = json.at("gates");
  return {.min_quality_gate = optional_from<double>(gates.at("min_quality")),
          .volume_gap_gate = number_from(gates.at("volume_gap")),
          .strict = gates.at("strict"),
          .accept = gates.at("accept"),
          .accepted = json.at("accepted"),
          .reasons = json.at("reasons")};
}

Json to_json(const CertificateRun& run) {
  Json seconds = Json::object();
  for (const auto& [section, t] : run.seconds) seconds[section] = t;
  Json json = {{"seconds", seconds},
               {"points_per_s", json_of(run.points_per_s)},
               {"tets_per_s", json_of(run.tets_per_s)},
               {"peak_memory_MB", run.peak_memory_MB},
               {"threads", run.threads},
               {"host", run.host},
               {"date", run.date}};
  if (!run.checksum.empty()) json["checksum"] = run.checksum;
  return json;
}

CertificateRun run_from(const Json& json) {
  CertificateRun run;
  for (const auto& [section, t] : json.at("seconds").items()) run.seconds.emplace_back(section, number_from(t));
  run.points_per_s = optional_from<double>(json.at("points_per_s"));
  run.tets_per_s = optional_from<double>(json.at("tets_per_s"));
  run.peak_memory_MB = number_from(json.at("peak_memory_MB"));
  run.threads = json.at("threads");
  run.host = json.at("host");
  run.date = json.at("date");
  run.checksum = json.value("checksum", "");
  return run;
}

}  // namespace

Json document_head(const std::string& version) {
  return {{"schema", kSchema}, {"tool", "umtet"}, {"version", version}};
}

Json to_json(const MeshCertificate& c) { return mesh_blocks(c, c.coordinate_rounding / c.h); }

Json to_json(const SecondOrderReport& report) {
  const SecondOrderCertificate& c = report.certificate;
  Json json = {{"n_nodes", c.n_nodes},
               {"volume", c.volume},
               {"min_scaled_jacobian", c.min_scaled_jacobian_lower},
               {"min_scaled_jacobian_upper", c.min_scaled_jacobian_upper},
               {"n_nonpositive_jacobians", c.n_nonpositive_jacobians},
               {"n_torn_edges", c.n_torn_edges},
               {"n_boundary_mid_sides", c.n_boundary_mid_sides},
               {"n_mid_sides_off_surface", c.n_mid_sides_off_surface},
               {"max_mid_side_distance_over_h", json_of(c.max_mid_side_distance_over_h)},
               {"max_face_distance_over_h", json_of(c.max_face_distance_over_h)},
               {"rms_face_distance_over_h", json_of(c.rms_face_distance_over_h)}};
  if (!report.repairs) return json;
  json.update({{"n_mid_sides_put_back", report.repairs->n_mid_sides_put_back},
               {"n_mid_sides_unprojected", report.repairs->n_mid_sides_unprojected},
               {"n_mid_sides_slid", report.repairs->n_mid_sides_slid},
               {"n_mid_sides_relaxed", report.repairs->n_mid_sides_relaxed}});
  return json;
}

Json to_json(const Verdict& v) {
  return {{"gates",
           {{"min_quality", json_of(v.min_quality_gate)},
            {"volume_gap", v.volume_gap_gate},
            {"strict", v.strict},
            {"accept", v.accept}}},
          {"verdict", v.word()},
          {"accepted", v.accepted},
          {"reasons", v.reasons}};
}

Json to_json(const MeshMeasures& measured) {
  Json json = measured_blocks(measured);
  json["reasons"] = measured.reasons;
  add_order(measured, json);
  return json;
}

MeshMeasures measures_from(const Json& json) {
  MeshMeasures m = measured_blocks_from(json);
  m.reasons = json.at("reasons");
  return m;
}

Json to_json(const MeshMeasures& measured, const Verdict& verdict) {
  Json json = measured_blocks(measured);
  add_order(measured, json);
  json.update(to_json(verdict));
  return json;
}

Json to_json(const Certificate& c) {
  Json json = document_head(c.version);
  json["units"] = json_of(c.units);
  json.update(measured_blocks(c.measured));
  add_order(c.measured, json);
  json["n_tets_asked"] = json_of(c.n_tets_asked);
  json.update(to_json(c.verdict));
  json["remedy"] = json_of(c.remedy);
  if (c.run) json["run"] = to_json(*c.run);
  return json;
}

Certificate certificate_from(const Json& json) {
  try {
    Certificate c;
    c.version = json.at("version");
    c.units = optional_from<std::string>(json.at("units"));
    c.measured = measured_blocks_from(json);
    c.n_tets_asked = optional_from<std::int64_t>(json.at("n_tets_asked"));
    c.verdict = verdict_from(json);
    c.remedy = optional_from<std::string>(json.at("remedy"));
    if (json.contains("run")) c.run = run_from(json.at("run"));
    return c;
  } catch (const Json::exception& e) {
    throw ArtefactDamaged(std::string("not a certificate: ") + e.what());
  }
}

Json to_json(const MeshCheck& check) {
  Json json = document_head(kVersion);
  json["mesh"] = check.file;
  json["units"] = json_of(check.units);
  json.update(to_json(check.mesh));
  json["order"] = check.second_order ? 2 : 1;
  json["second_order"] = second_order_block(check.second_order);
  json["domain"] = to_json(check.support);
  json["valid"] = check.is_valid;
  json["places"] = check.places ? to_json(*check.places) : Json(nullptr);
  json["verdict"] = check.verdict.word();
  json["accepted"] = check.verdict.accepted;
  json["reasons"] = check.verdict.reasons;
  return json;
}

}  // namespace umtet
