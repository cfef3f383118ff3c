#include "pipeline/reports/mesh_json.h"

namespace umtet {

void list_fields(JsonFields& json, MeshCertificate::Quality& q) {
  json("min", q.min)("p001", q.p001)("p01", q.p01)("mean", q.mean);
  json("dihedral_min_deg", q.dihedral_min_deg)("dihedral_max_deg", q.dihedral_max_deg)("n_inverted", q.n_inverted);
}

void list_fields(JsonFields& json, MeshCertificate& c, double& coordinate_rounding_over_h) {
  MeshCertificate::Boundary& b = c.boundary;
  json("n_tets", c.n_tets);
  json("n_vertices", c.n_vertices);
  std::optional<std::size_t> n_positive_faces;
  if (b.equals_positive_faces) n_positive_faces = c.n_positive_faces;
  json("n_positive_faces", n_positive_faces);
  c.n_positive_faces = n_positive_faces.value_or(0);
  json("n_wall_faces", c.n_wall_faces);
  json("h", c.h);
  json("volume", c.volume);
  json("quality", c.quality);
  json.object("boundary", [&](JsonFields& block) {
    block("closed_manifold", b.closed_manifold);
    block("self_intersections", b.n_self_intersections);
    block("wrongly_nested", b.n_wrongly_nested);
    block.derived("embedded", c.is_embedded());
    block("equals_positive_faces", b.equals_positive_faces);
    block("components", b.components);
    block("euler_characteristic", b.euler_characteristic);
    block("genus", b.genus);
    block("n_faces", b.n_faces);
    block("area", b.area);
    block("max_vertex_distance_over_h", b.max_vertex_distance_over_h);
    block("coordinate_rounding_over_h", coordinate_rounding_over_h);
    block("max_centroid_distance_over_h", b.max_centroid_distance_over_h);
    block("min_cos_normal", b.min_cos_normal);
    block("gap_over_volume", b.gap_over_volume);
    block("n_cos_below_half", b.n_cos_below_half);
  });
}

Json to_json(const MeshCertificate& certificate) {
  MeshCertificate c = certificate;
  double coordinate_rounding_over_h = c.coordinate_rounding / c.h;
  Json made = Json::object();
  JsonFields json(made);
  list_fields(json, c, coordinate_rounding_over_h);
  return made;
}

void list_fields(JsonFields& json, SecondOrderReport& report) {
  SecondOrderCertificate& c = report.certificate;
  json("n_nodes", c.n_nodes);
  json("volume", c.volume);
  json("min_scaled_jacobian", c.min_scaled_jacobian_lower);
  json("min_scaled_jacobian_upper", c.min_scaled_jacobian_upper);
  json("n_nonpositive_jacobians", c.n_nonpositive_jacobians);
  json("n_torn_edges", c.n_torn_edges);
  json("n_boundary_mid_sides", c.n_boundary_mid_sides);
  json("n_mid_sides_off_surface", c.n_mid_sides_off_surface);
  json("max_mid_side_distance_over_h", c.max_mid_side_distance_over_h);
  json("max_face_distance_over_h", c.max_face_distance_over_h);
  json("rms_face_distance_over_h", c.rms_face_distance_over_h);
  if (json.contains("n_mid_sides_put_back")) report.repairs.emplace();
  if (!report.repairs) return;
  json("n_mid_sides_put_back", report.repairs->n_mid_sides_put_back);
  json("n_mid_sides_unprojected", report.repairs->n_mid_sides_unprojected);
  json("n_mid_sides_slid", report.repairs->n_mid_sides_slid);
  json("n_mid_sides_relaxed", report.repairs->n_mid_sides_relaxed);
}

}  // namespace umtet
