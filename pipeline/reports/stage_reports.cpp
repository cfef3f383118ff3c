#include "pipeline/reports/stage_reports.h"

#include <fmt/format.h>

#include "pipeline/case/exit_code.h"
#include "pipeline/case/option_words.h"
#include "pipeline/reports/certificate_json.h"

namespace umtet {
namespace {

// In the order of WindingReport::Verdict.
constexpr std::array kWindingVerdicts = {"agrees", "uncertain", "not better", "taken"};

Json to_json(const HeldOutResidual& r) {
  return {{"spacing", r.spacing},
          {"rms_value", r.rms_value},
          {"normal_defect", r.normal_defect},
          {"opposed_share", r.opposed_share}};
}

HeldOutResidual held_out_from(const Json& json) {
  return {.spacing = number_from(json.at("spacing")),
          .rms_value = number_from(json.at("rms_value")),
          .normal_defect = number_from(json.at("normal_defect")),
          .opposed_share = number_from(json.at("opposed_share"))};
}

Json to_json(const WindingCheckReport& w) {
  Json json = {{"verdict", kWindingVerdicts[static_cast<std::size_t>(w.verdict)]},
               {"restored", w.restored},
               {"off_before", w.off_before},
               {"off_after", w.off_after},
               {"off_tried", w.off_tried},
               {"consistency_before", w.consistency_before},
               {"consistency_tried", w.consistency_tried}};
  if (w.held_out_before) json["held_out_before"] = to_json(*w.held_out_before);
  if (w.held_out_tried) json["held_out_tried"] = to_json(*w.held_out_tried);
  return json;
}

WindingCheckReport winding_from(const Json& json) {
  WindingCheckReport w;
  const auto* const verdict =
      std::find(kWindingVerdicts.begin(), kWindingVerdicts.end(), json.at("verdict").get<std::string>());
  if (verdict == kWindingVerdicts.end()) throw ArtefactDamaged("the result of the winding number is unknown");
  w.verdict = static_cast<WindingReport::Verdict>(verdict - kWindingVerdicts.begin());
  w.restored = json.at("restored");
  w.off_before = number_from(json.at("off_before"));
  w.off_after = number_from(json.at("off_after"));
  w.off_tried = number_from(json.at("off_tried"));
  w.consistency_before = number_from(json.at("consistency_before"));
  w.consistency_tried = number_from(json.at("consistency_tried"));
  if (json.contains("held_out_before")) w.held_out_before = held_out_from(json.at("held_out_before"));
  if (json.contains("held_out_tried")) w.held_out_tried = held_out_from(json.at("held_out_tried"));
  return w;
}

Json to_json(const NormalsReport& n) {
  Json json = {{"source", n.given ? "given" : "estimated"}};
  if (n.missing) json["missing"] = *n.missing;
  json["consistency"] = n.consistency;
  if (const std::optional<OrientationReport>& o = n.orientation) {
    json.update({{"consistency_after", o->consistency_after},
                 {"turned", o->n_turned},
                 {"pieces", o->n_components},
                 {"cavities", o->n_cavities},
                 {"doubtful", o->n_doubtful}});
  }
  if (n.turned_to_viewpoints) json["turned_to_viewpoints"] = *n.turned_to_viewpoints;
  if (n.turned_by_winding) json["turned_by_winding"] = *n.turned_by_winding;
  if (n.replaced_by_winding) json["replaced_by_winding"] = *n.replaced_by_winding;
  if (n.winding) json["winding"] = to_json(*n.winding);
  return json;
}

NormalsReport normals_from(const Json& json) {
  NormalsReport n;
  n.given = json.at("source") == "given";
  if (json.contains("missing")) n.missing = json.at("missing");
  n.consistency = number_from(json.at("consistency"));
  if (json.contains("turned")) {
    OrientationReport& o = n.orientation.emplace();
    o.consistency = n.consistency;
    o.consistency_after = number_from(json.at("consistency_after"));
    o.n_turned = json.at("turned");
    o.n_components = json.at("pieces");
    o.n_cavities = json.at("cavities");
    o.n_doubtful = json.at("doubtful");
  }
  if (json.contains("turned_to_viewpoints")) n.turned_to_viewpoints = json.at("turned_to_viewpoints");
  if (json.contains("turned_by_winding")) n.turned_by_winding = json.at("turned_by_winding");
  if (json.contains("replaced_by_winding")) n.replaced_by_winding = json.at("replaced_by_winding");
  if (json.contains("winding")) n.winding = winding_from(json.at("winding"));
  return n;
}

std::vector<PlaneCap> caps_from(const Json& json) {
  std::vector<PlaneCap> caps;
  for (const Json& cap : json)
    caps.push_back({.centre = vector_from(cap.at("centre")),
                    .normal = vector_from(cap.at("normal")),
                    .area = number_from(cap.at("area")),
                    .off_plane = number_from(cap.at("off_plane")),
                    .n_triangles = cap.at("n_triangles")});
  return caps;
}

TrianglesReport triangles_from(const Json& json) {
  TrianglesReport t;
  t.n_vertices = json.at("n_vertices");
  t.n_faces = json.at("n_faces");
  t.n_polygons = json.at("n_polygons");
  TriangleReport& b = t.body;
  b.n_triangles = json.at("n_triangles");
  b.dropped = {.n_degenerate = json.at("n_degenerate"), .n_duplicates = json.at("n_duplicates")};
  b.sides = {.n_open_edges = json.at("n_open_edges"),
             .n_branching_edges = json.at("n_branching_edges"),
             .n_one_sided_edges = json.at("n_one_sided_edges"),
             .weld_distance = number_from(json.at("weld_distance")),
             .n_patches = json.at("n_patches"),
             .n_closed_patches = json.at("n_closed_patches"),
             .n_turned = json.at("n_turned"),
             .n_cavities = json.at("n_cavities"),
             .n_inner_shells = json.at("n_inner_shells")};
  b.spacing = number_from(json.at("sample_spacing"));
  b.n_samples = json.at("n_samples");
  b.n_inside = json.at("n_samples_inside");
  b.n_inside_out = json.at("n_samples_inside_out");
  b.unsure = number_from(json.at("unsure"));
  t.n_boundary = json.at("n_boundary");
  t.n_labels = json.value("n_labels", std::size_t{0});
  b.least_spacing = json.value("least_sample_spacing", b.spacing);
  if (json.contains("thickness") && json.at("thickness").is_number()) b.thickness = json.at("thickness").get<double>();
  if (json.contains("caps")) b.caps = caps_from(json.at("caps"));
  if (json.contains("touching")) {
    const Json& touching = json.at("touching");
    b.touching = {.n_contacts = touching.at("contacts"),
                  .n_pieces = touching.at("pieces"),
                  .width = number_from(touching.at("width"))};
  }
  t.label_names = json.at("label_names");
  return t;
}

Json to_json(const BandReport& b) {
  return {{"spacing", b.spacing}, {"smoothing", b.smoothing},   {"n_samples", b.n_samples},
          {"n_nodes", b.n_nodes}, {"iterations", b.iterations}, {"residual", b.residual}};
}

BandReport band_from(const Json& json) {
  return {.spacing = number_from(json.at("spacing")),
          .smoothing = number_from(json.at("smoothing")),
          .n_samples = json.at("n_samples"),
          .n_nodes = json.at("n_nodes"),
          .iterations = json.at("iterations"),
          .residual = number_from(json.at("residual"))};
}

MergedReport merged_from(const Json& json) {
  return {.n_points = json.at("n_points"), .n_samples = json.at("n_samples"), .cell = number_from(json.at("cell"))};
}

std::vector<Message> messages_from(const Json& texts) {
  std::vector<Message> messages;
  for (const Json& text : texts) messages.emplace_back(text.get<std::string>());
  return messages;
}

CloudReport cloud_from(const Json& json) {
  const Json& dropped = json.at("dropped");
  return {.format = json.at("format"),
          .n_points_in_file = json.at("n_points_in_file"),
          .n_normals_rescaled = json.at("n_normals_rescaled"),
          .dropped = {.not_finite = dropped.at("not_finite"),
                      .duplicates = dropped.at("duplicates"),
                      .outliers = dropped.at("outliers"),
                      .small_components = dropped.at("small_components")},
          .normals = normals_from(json.at("normals")),
          .triangles = json.contains("triangles") ? std::optional(triangles_from(json.at("triangles"))) : std::nullopt,
          .n_points = json.at("n_points"),
          .fields = json.value("fields", std::vector<std::string>()),
          .columns = json.value("columns", std::string()),
          .merged = json.contains("merged") ? std::optional(merged_from(json.at("merged"))) : std::nullopt,
          .box = {vector_from(json.at("box_min")), vector_from(json.at("box_max"))},
          .notices = messages_from(json.at("notices"))};
}

constexpr std::array kHowClosed = {"as fitted", "smooth", "flat"};  // in the order of FittedHole::How

Json to_json(const FittedHole& h) {
  return {{"centre", json_of(h.hole.centre)},
          {"normal", json_of(h.hole.normal)},
          {"area", h.hole.area},
          {"depth", h.hole.depth},
          {"rim_cosine", h.hole.rim_cosine},
          {"closed", kHowClosed[static_cast<std::size_t>(h.how)]}};
}

FittedHole fitted_hole_from(const Json& json) {
  FittedHole h;
  h.hole.centre = vector_from(json.at("centre"));
  h.hole.normal = vector_from(json.at("normal"));
  h.hole.area = number_from(json.at("area"));
  h.hole.depth = number_from(json.at("depth"));
  h.hole.rim_cosine = number_from(json.at("rim_cosine"));
  const auto* const how = std::find(kHowClosed.begin(), kHowClosed.end(), json.at("closed").get<std::string>());
  if (how == kHowClosed.end()) throw ArtefactDamaged("the way in which a hole of the level set is closed is unknown");
  h.how = static_cast<FittedHole::How>(how - kHowClosed.begin());
  return h;
}

LevelSetReport level_set_from(const Json& json) {
  LevelSetReport r;
  r.shift = vector_from(json.at("shift"));
  r.noise = number_from(json.at("noise"));
  if (json.contains("noise_bias")) r.noise_bias = number_from(json.at("noise_bias"));
  if (const Json& t = json.at("thickness_percentiles_1_5_50"); !t.is_null()) {
    const Eigen::Vector3d percentiles = vector_from(t);
    r.thickness = {percentiles[0], percentiles[1], percentiles[2]};
  }
  SsdReport& fit = r.fit;
  fit.n_points = json.at("n_points");
  fit.n_nodes = json.at("n_nodes");
  fit.spacing = number_from(json.at("spacing"));
  fit.smoothing = number_from(json.at("smoothing"));
  fit.reason = json.at("reason");
  fit.cloud_spacing = number_from(json.at("cloud_spacing"));
  fit.iterations = json.at("iterations");
  for (const Json& residual : json.at("residuals")) fit.residuals.push_back(number_from(residual));
  for (const Json& band : json.at("bands")) fit.bands.push_back(band_from(band));
  fit.energy_value = number_from(json.at("energy_value"));
  fit.energy_normal = number_from(json.at("energy_normal"));
  fit.energy_hessian = number_from(json.at("energy_hessian"));
  fit.rms_value = number_from(json.at("rms_value"));
  fit.normal_defect = number_from(json.at("normal_defect"));
  fit.n_opposed_normals = json.at("n_opposed_normals");
  fit.n_turned_normals = json.at("n_turned_normals");
  for (const Json& hole : json.at("holes")) fit.holes.push_back(fitted_hole_from(hole));
  fit.least_wall_value = number_from(json.at("least_wall_value"));
  r.left_out_finer = json.contains("wanted");
  return r;
}

MeshReport mesh_report_from(const Json& json) {
  return {.conditioning_angle_max_deg = number_from(json.at("conditioning_angle_max_deg")),
          .n_psi_evaluations = json.at("n_psi_evaluations"),
          .measured = measures_from(json.at("measured"))};
}

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

Json to_json(const TrianglesReport& t) {
  const TriangleReport& b = t.body;
  const FaceSidesReport& s = b.sides;
  Json caps = Json::array();
  for (const PlaneCap& cap : b.caps)
    caps.push_back({{"centre", json_of(cap.centre)},
                    {"normal", json_of(cap.normal)},
                    {"area", cap.area},
                    {"off_plane", cap.off_plane},
                    {"n_triangles", cap.n_triangles}});
  return {
      {"n_vertices", t.n_vertices},
      {"n_faces", t.n_faces},
      {"n_polygons", t.n_polygons},
      {"n_triangles", b.n_triangles},
      {"n_degenerate", b.dropped.n_degenerate},
      {"n_duplicates", b.dropped.n_duplicates},
      {"n_open_edges", s.n_open_edges},
      {"n_branching_edges", s.n_branching_edges},
      {"n_one_sided_edges", s.n_one_sided_edges},
      {"weld_distance", s.weld_distance},
      {"n_patches", s.n_patches},
      {"n_closed_patches", s.n_closed_patches},
      {"n_turned", s.n_turned},
      {"n_cavities", s.n_cavities},
      {"n_inner_shells", s.n_inner_shells},
      {"sample_spacing", b.spacing},
      {"least_sample_spacing", b.least_spacing},
      {"thickness", b.thickness ? Json(*b.thickness) : Json()},
      {"caps", std::move(caps)},
      {"touching", {{"contacts", b.touching.n_contacts}, {"pieces", b.touching.n_pieces}, {"width", b.touching.width}}},
      {"n_samples", b.n_samples},
      {"n_samples_inside", b.n_inside},
      {"n_samples_inside_out", b.n_inside_out},
      {"unsure", b.unsure},
      {"n_boundary", t.n_boundary},
      {"label_names", t.label_names},
      {"n_labels", t.n_labels}};
}

Json to_json(const CloudReport& r, const Json& wanted) {
  Json json = {{"format", r.format},
               {"n_points_in_file", r.n_points_in_file},
               {"n_normals_rescaled", r.n_normals_rescaled},
               {"dropped",
                {{"not_finite", r.dropped.not_finite},
                 {"duplicates", r.dropped.duplicates},
                 {"outliers", r.dropped.outliers},
                 {"small_components", r.dropped.small_components}}},
               {"normals", to_json(r.normals)},
               {"n_points", r.n_points},
               {"box_min", json_of(r.box.min())},
               {"box_max", json_of(r.box.max())},
               {"notices", texts_of(r.notices, as_flag)}};
  if (r.triangles) json["triangles"] = to_json(*r.triangles);
  if (!r.fields.empty()) json["fields"] = r.fields;
  if (!r.columns.empty()) json["columns"] = r.columns;
  if (const std::optional<MergedReport>& m = r.merged) {
    json["merged"] = {{"n_points", m->n_points}, {"n_samples", m->n_samples}, {"cell", m->cell}, {"wanted", wanted}};
  }
  return json;
}

Json to_json(const LevelSetReport& r, const Json& wanted) {
  const SsdReport& fit = r.fit;
  Json bands = Json::array();
  for (const BandReport& band : fit.bands) bands.push_back(to_json(band));
  Json holes = Json::array();
  for (const FittedHole& hole : fit.holes) holes.push_back(to_json(hole));
  Json json = {{"shift", json_of(r.shift)},
               {"n_points", fit.n_points},
               {"n_nodes", fit.n_nodes},
               {"spacing", fit.spacing},
               {"smoothing", fit.smoothing},
               {"noise", r.noise},
               {"noise_bias", r.noise_bias},
               {"reason", fit.reason},
               {"cloud_spacing", fit.cloud_spacing},
               {"thickness_percentiles_1_5_50", json_of(r.thickness)},
               {"iterations", fit.iterations},
               {"residuals", fit.residuals},
               {"bands", bands},
               {"energy_value", fit.energy_value},
               {"energy_normal", fit.energy_normal},
               {"energy_hessian", fit.energy_hessian},
               {"rms_value", fit.rms_value},
               {"normal_defect", fit.normal_defect},
               {"n_opposed_normals", fit.n_opposed_normals},
               {"n_turned_normals", fit.n_turned_normals},
               {"holes", holes},
               {"least_wall_value", fit.least_wall_value}};
  if (r.left_out_finer) json["wanted"] = wanted;
  return json;
}

Json to_json(const MeshReport& r) {
  return {{"conditioning_angle_max_deg", r.conditioning_angle_max_deg},
          {"n_psi_evaluations", r.n_psi_evaluations},
          {"measured", to_json(r.measured)}};
}

CloudReport cloud_report(const StageRecord& record) { return report_of(record, &cloud_from); }
LevelSetReport level_set_report(const StageRecord& record) { return report_of(record, &level_set_from); }
MeshReport mesh_report(const StageRecord& record) { return report_of(record, &mesh_report_from); }

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
