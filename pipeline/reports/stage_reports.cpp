#include "pipeline/reports/stage_reports.h"

#include <fmt/format.h>

#include <array>

#include "pipeline/case/exit_code.h"
#include "pipeline/case/option_words.h"
#include "pipeline/reports/certificate_json.h"

namespace umtet {

void list_fields(JsonFields& json, HeldOutResidual& r) {
  json("spacing", r.spacing)("rms_value", r.rms_value)("normal_defect", r.normal_defect);
  json("opposed_share", r.opposed_share);
}

void list_fields(JsonFields& json, WindingCheckReport& w) {
  json.word("verdict", w.verdict, std::array{"agrees", "uncertain", "not better", "taken"});
  json("restored", w.restored);
  json("off_before", w.off_before);
  json("off_after", w.off_after);
  json("off_tried", w.off_tried);
  json("consistency_before", w.consistency_before);
  json("consistency_tried", w.consistency_tried);
  json.if_any("held_out_before", w.held_out_before);
  json.if_any("held_out_tried", w.held_out_tried);
}

void list_fields(JsonFields& json, NormalsReport& n) {
  json.word("source", n.given, std::array{"estimated", "given"});
  json.if_any("missing", n.missing);
  json("consistency", n.consistency);
  if (json.contains("turned")) n.orientation.emplace().consistency = n.consistency;
  if (n.orientation) {
    json("consistency_after", n.orientation->consistency_after);
    json("turned", n.orientation->n_turned);
    json("pieces", n.orientation->n_components);
    json("cavities", n.orientation->n_cavities);
    json("doubtful", n.orientation->n_doubtful);
  }
  json.if_any("turned_to_viewpoints", n.turned_to_viewpoints);
  json.if_any("turned_by_winding", n.turned_by_winding);
  json.if_any("replaced_by_winding", n.replaced_by_winding);
  json.if_any("winding", n.winding);
}

void list_fields(JsonFields& json, PlaneCap& cap) {
  json("centre", cap.centre)("normal", cap.normal)("area", cap.area)("off_plane", cap.off_plane);
  json("n_triangles", cap.n_triangles);
}

void list_fields(JsonFields& json, TouchingReport& touching) {
  json("contacts", touching.n_contacts)("pieces", touching.n_pieces)("width", touching.width);
}

void list_fields(JsonFields& json, TrianglesReport& t) {
  TriangleReport& b = t.body;
  FaceSidesReport& s = b.sides;
  json("n_vertices", t.n_vertices)("n_faces", t.n_faces)("n_polygons", t.n_polygons);
  json("n_triangles", b.n_triangles);
  json("n_degenerate", b.dropped.n_degenerate)("n_duplicates", b.dropped.n_duplicates);
  json("n_open_edges", s.n_open_edges);
  json("n_branching_edges", s.n_branching_edges);
  json("n_one_sided_edges", s.n_one_sided_edges);
  json("weld_distance", s.weld_distance);
  json("n_patches", s.n_patches)("n_closed_patches", s.n_closed_patches);
  json("n_turned", s.n_turned);
  json("n_cavities", s.n_cavities)("n_inner_shells", s.n_inner_shells);
  json("sample_spacing", b.spacing)("least_sample_spacing", b.least_spacing);
  json("thickness", b.thickness);
  json("caps", b.caps);
  json("touching", b.touching);
  json("n_samples", b.n_samples)("n_samples_inside", b.n_inside)("n_samples_inside_out", b.n_inside_out);
  json("unsure", b.unsure);
  json("n_boundary", t.n_boundary);
  json("label_names", t.label_names)("n_labels", t.n_labels);
}

void list_fields(JsonFields& json, MergedReport& m) {
  json("n_points", m.n_points)("n_samples", m.n_samples)("cell", m.cell);
}

void list_fields(JsonFields& json, CloudReport::Dropped& dropped) {
  json("not_finite", dropped.not_finite)("duplicates", dropped.duplicates)("outliers", dropped.outliers);
  json("small_components", dropped.small_components);
}

void list_fields(JsonFields& json, CloudReport& r) {
  json("format", r.format);
  json("n_points_in_file", r.n_points_in_file);
  json("n_normals_rescaled", r.n_normals_rescaled);
  json("dropped", r.dropped);
  json("normals", r.normals);
  json("n_points", r.n_points);
  json("box_min", r.box.min())("box_max", r.box.max());
  std::vector<std::string> notices = texts_of(r.notices, as_flag);
  json("notices", notices);
  r.notices.assign(notices.begin(), notices.end());
  json.if_any("triangles", r.triangles);
  json.if_any("fields", r.fields);
  json.if_any("columns", r.columns);
  json.if_any("merged", r.merged);
}

void list_fields(JsonFields& json, BandReport& b) {
  json("spacing", b.spacing)("smoothing", b.smoothing)("n_samples", b.n_samples);
  json("n_nodes", b.n_nodes)("iterations", b.iterations)("residual", b.residual);
}

void list_fields(JsonFields& json, FittedHole& h) {
  json("centre", h.hole.centre)("normal", h.hole.normal)("area", h.hole.area)("depth", h.hole.depth);
  json("rim_cosine", h.hole.rim_cosine).word("closed", h.how, std::array{"as fitted", "smooth", "flat"});
}

void list_fields(JsonFields& json, LevelSetReport& r) {
  SsdReport& fit = r.fit;
  json("shift", r.shift);
  json("n_points", fit.n_points)("n_nodes", fit.n_nodes);
  json("spacing", fit.spacing)("smoothing", fit.smoothing);
  json("noise", r.noise)("noise_bias", r.noise_bias);
  json("reason", fit.reason);
  json("cloud_spacing", fit.cloud_spacing);
  json("thickness_percentiles_1_5_50", r.thickness);
  json("iterations", fit.iterations)("residuals", fit.residuals)("bands", fit.bands);
  json("energy_value", fit.energy_value)("energy_normal", fit.energy_normal)("energy_hessian", fit.energy_hessian);
  json("rms_value", fit.rms_value)("normal_defect", fit.normal_defect);
  json("n_opposed_normals", fit.n_opposed_normals)("n_turned_normals", fit.n_turned_normals);
  json("holes", fit.holes);
  json("least_wall_value", fit.least_wall_value);
  if (json.is_reading()) r.left_out_finer = json.contains("wanted");
}

void list_fields(JsonFields& json, MeshReport& r) {
  json("conditioning_angle_max_deg", r.conditioning_angle_max_deg)("n_psi_evaluations", r.n_psi_evaluations);
  json("measured", r.measured);
}

namespace {

template <class Report>
Report report_of(const StageRecord& record, Report (*from)(const Json&)) {
  try {
    return from(record.numbers);
  } catch (const Json::exception& e) {
    throw ArtefactDamaged(
        fmt::format("a number is missing in the record of {}: {}", to_string(record.stage), e.what()));
  }
}

}  // namespace

Json to_json(const TrianglesReport& report) { return json_by_fields(report); }

Json to_json(const CloudReport& report, const Json& wanted) {
  Json json = json_by_fields(report);
  if (report.merged) json["merged"]["wanted"] = wanted;
  return json;
}

Json to_json(const LevelSetReport& report, const Json& wanted) {
  Json json = json_by_fields(report);
  if (report.left_out_finer) json["wanted"] = wanted;
  return json;
}

Json to_json(const MeshReport& report) { return json_by_fields(report); }

CloudReport cloud_report(const StageRecord& record) { return report_of(record, &read_fields<CloudReport>); }
LevelSetReport level_set_report(const StageRecord& record) { return report_of(record, &read_fields<LevelSetReport>); }
MeshReport mesh_report(const StageRecord& record) { return report_of(record, &read_fields<MeshReport>); }

std::optional<Json> wanted_of(const StageRecord& record) {
  return report_of<std::optional<Json>>(record, [](const Json& json) -> std::optional<Json> {
    const Json& from = json.contains("merged") ? json.at("merged") : json;
    if (!from.contains("wanted")) return std::nullopt;
    return std::optional<Json>(std::in_place, from.at("wanted"));
  });
}

std::vector<std::string> label_names_of_file(const CasePaths& paths) {
  const StageState state = inspect_stage(paths, Stage::Cloud, Json::object(), std::nullopt);
  if (!state.record) return {};
  const std::optional<TrianglesReport> triangles = cloud_report(*state.record).triangles;
  return triangles ? triangles->label_names : std::vector<std::string>();
}

}  // namespace umtet
