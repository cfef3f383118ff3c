#include "pipeline/reports/mesh_json.h"

namespace umtet {

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

}  // namespace umtet
