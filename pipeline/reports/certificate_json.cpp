#include "pipeline/reports/certificate_json.h"

#include "pipeline/case/exit_code.h"
#include "pipeline/reports/comparison_json.h"
#include "pipeline/reports/defect_json.h"
#include "pipeline/reports/label_json.h"
#include "pipeline/reports/mesh_json.h"
#include "pipeline/reports/region_json.h"

namespace umtet {
namespace {

constexpr int kSchema = 1;

Json second_order_block(const std::optional<SecondOrderReport>& second) {
  return second ? to_json(*second) : Json(nullptr);
}

Json to_json(const InputFacts& facts) {
  return {{"normals_given", facts.normals_given},
          {"turned", facts.turned},
          {"turned_by", facts.turned_by},
          {"doubtful", facts.doubtful},
          {"opposed", facts.opposed},
          {"consistency", facts.consistency},
          {"off_a_half", json_of(facts.off_a_half)}};
}

InputFacts input_facts_from(const Json& json) {
  return {.normals_given = json.at("normals_given"),
          .turned = number_from(json.at("turned")),
          .turned_by = json.at("turned_by"),
          .doubtful = number_from(json.at("doubtful")),
          .opposed = number_from(json.at("opposed")),
          .consistency = number_from(json.at("consistency")),
          .off_a_half = optional_from<double>(json.at("off_a_half"))};
}

Json to_json(const SearchReport& search) {
  return {{"n_attempts", search.n_attempts}, {"h_is_given", search.h_is_given}, {"at_max_tets", search.at_max_tets}};
}

SearchReport search_from(const Json& json) {
  return {
      .n_attempts = json.at("n_attempts"), .h_is_given = json.at("h_is_given"), .at_max_tets = json.at("at_max_tets")};
}

/// The measurements up to the resolution.
Json measured_blocks(const MeshMeasures& m) {
  Json json = {{"n_points", json_of(m.n_points)}};
  json.update(mesh_blocks(m.mesh, m.coordinate_rounding_over_h));
  json["domain"] = to_json(m.domain);
  json["cloud"] = m.cloud ? to_json(*m.cloud, m.mesh.h) : Json(nullptr);
  if (m.triangles) json["triangles"] = to_json(*m.triangles);
  if (m.labels) json["labels"] = to_json(*m.labels);
  if (m.features) json["features"] = to_json(*m.features);
  json["resolution"] = to_json(m.resolution, m.mesh.h);
  if (m.sizes) json["sizes"] = to_json(*m.sizes);
  if (m.input) json["input"] = to_json(*m.input);
  if (m.search) json["search"] = to_json(*m.search);
  json["valid"] = m.is_valid;
  json["places"] = to_json(m.defects);
  return json;
}

void add_order(const MeshMeasures& m, Json& json) {
  if (!m.order) return;
  json["order"] = *m.order;
  json["second_order"] = second_order_block(m.second_order);
}

/// All measurements except the reasons.
MeshMeasures measured_blocks_from(const Json& json) {
  MeshMeasures m;
  m.n_points = optional_from<std::size_t>(json.at("n_points"));
  m.mesh = mesh_from(json);
  m.coordinate_rounding_over_h = number_from(json.at("boundary").at("coordinate_rounding_over_h"));
  m.domain = zero_set_from(json.at("domain"));
  if (!json.at("cloud").is_null()) m.cloud = distances_from(json.at("cloud"));
  if (json.contains("triangles")) m.triangles = triangle_distances_from(json.at("triangles"));
  if (json.contains("labels")) m.labels = label_volume_from(json.at("labels"));
  if (json.contains("features")) m.features = features_from(json.at("features"));
  m.resolution = resolution_from(json.at("resolution"));
  if (json.contains("sizes")) m.sizes = sizes_from(json.at("sizes"));
  if (json.contains("input")) m.input = input_facts_from(json.at("input"));
  if (json.contains("search")) m.search = search_from(json.at("search"));
  m.is_valid = json.at("valid");
  m.defects = defects_from(json.at("places"));
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
          .is_valid = json.at("valid"),
          .fits_psi = json.at("fits_psi"),
          .fits_input = json.at("fits_input"),
          .accepted = json.at("accepted"),
          .defects = json.at("defects"),
          .n_defects = json.at("n_defects"),
          .reasons = json.at("reasons")};
}

Json blame_json(const std::optional<Blame>& blame) {
  if (!blame) return nullptr;
  return {{"stage", blame->stage}, {"number", blame->number}, {"remedy", blame->remedy}};
}

std::optional<Blame> blame_from(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return Blame{json.at("stage"), json.at("number"), json.at("remedy")};
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

Json to_json(const Verdict& v) {
  return {{"gates",
           {{"min_quality", json_of(v.min_quality_gate)},
            {"volume_gap", v.volume_gap_gate},
            {"strict", v.strict},
            {"accept", v.accept}}},
          {"fits_psi", v.fits_psi},
          {"fits_input", v.fits_input},
          {"verdict", v.word()},
          {"n_defects", v.n_defects},
          {"defects", v.defects},
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
  json["blame"] = blame_json(c.blame);
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
    c.blame = blame_from(json.at("blame"));
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
  json["regions"] = json["interfaces"] = json["unshared_faces"] = nullptr;
  if (check.regions) {
    const auto& [file, certificate] = *check.regions;
    json["regions"] = json_of_regions(certificate, file.names);
    for (Json& region : json["regions"]) region["mark"] = file.marks[region["region"].get<std::size_t>()];
    json["interfaces"] = json_of_interfaces(certificate, file.names, false);
    json["unshared_faces"] = certificate.n_unshared_faces;
  }
  json["domain"] = to_json(check.support);
  json["valid"] = check.is_valid;
  json["places"] = check.defects ? to_json(*check.defects) : Json(nullptr);
  json["fits_psi"] = check.defects ? Json(check.verdict.fits_psi) : Json(nullptr);
  json["verdict"] = check.verdict.word();
  json["n_defects"] = check.verdict.n_defects;
  json["defects"] = check.verdict.defects;
  json["accepted"] = check.verdict.accepted;
  json["reasons"] = check.verdict.reasons;
  return json;
}

}  // namespace umtet
