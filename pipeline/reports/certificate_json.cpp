#include "pipeline/reports/certificate_json.h"

#include "pipeline/case/exit_code.h"
#include "pipeline/reports/comparison_json.h"
#include "pipeline/reports/defect_json.h"
#include "pipeline/reports/label_json.h"
#include "pipeline/reports/mesh_json.h"
#include "pipeline/reports/region_json.h"

namespace umtet {

void list_fields(JsonFields& json, InputFacts& facts) {
  json("normals_given", facts.normals_given)("turned", facts.turned)("turned_by", facts.turned_by);
  json("doubtful", facts.doubtful)("opposed", facts.opposed)("consistency", facts.consistency);
  json("off_a_half", facts.off_a_half);
}

void list_fields(JsonFields& json, SearchReport& search) {
  json("n_attempts", search.n_attempts)("h_is_given", search.h_is_given)("at_max_tets", search.at_max_tets);
}

void list_fields(JsonFields& json, Blame& blame) {
  json("stage", blame.stage)("number", blame.number)("remedy", blame.remedy);
}

void list_fields(JsonFields& json, Verdict& v) {
  json.object("gates", [&](JsonFields& gates) {
    gates("min_quality", v.min_quality_gate)("volume_gap", v.volume_gap_gate)("strict", v.strict)("accept", v.accept);
  });
  json("fits_psi", v.fits_psi);
  json("fits_input", v.fits_input);
  json.derived("verdict", v.word());
  json("n_defects", v.n_defects);
  json("defects", v.defects);
  json("accepted", v.accepted);
  json("reasons", v.reasons);
}

void list_fields(JsonFields& json, CertificateRun& run) {
  Json seconds = Json::object();
  for (const auto& [section, t] : run.seconds) seconds[section] = t;
  json("seconds", seconds);
  run.seconds.clear();
  for (const auto& [section, t] : seconds.items()) run.seconds.emplace_back(section, number_from(t));
  json("points_per_s", run.points_per_s);
  json("tets_per_s", run.tets_per_s);
  json("peak_memory_MB", run.peak_memory_MB);
  json("threads", run.threads);
  json("host", run.host);
  json("date", run.date);
  json.if_any("checksum", run.checksum);
}

namespace {

constexpr int kSchema = 1;

/// The measurements except the reasons and the order of the tets.
void list_blocks(JsonFields& json, MeshMeasures& m) {
  json("n_points", m.n_points);
  list_fields(json, m.mesh, m.coordinate_rounding_over_h);
  json("domain", m.domain);
  json("cloud", m.cloud, m.mesh.h);
  json.if_any("triangles", m.triangles);
  json.if_any("labels", m.labels);
  json.if_any("features", m.features);
  json("resolution", m.resolution, m.mesh.h);
  json.if_any("sizes", m.sizes);
  json.if_any("input", m.input);
  json.if_any("search", m.search);
  json("valid", m.is_valid);
  json("places", m.defects);
}

void list_order(JsonFields& json, MeshMeasures& m) {
  json.if_any("order", m.order);
  if (m.order) json("second_order", m.second_order);
}

}  // namespace

void list_fields(JsonFields& json, MeshMeasures& m) {
  list_blocks(json, m);
  json("reasons", m.reasons);
  list_order(json, m);
}

void list_fields(JsonFields& json, Certificate& c) {
  json.derived("schema", kSchema).derived("tool", "umtet")("version", c.version);
  json("units", c.units);
  list_blocks(json, c.measured);
  list_order(json, c.measured);
  json("n_tets_asked", c.n_tets_asked);
  list_fields(json, c.verdict);
  c.verdict.is_valid = c.measured.is_valid;
  json("blame", c.blame);
  json.if_any("run", c.run);
}

Json document_head(const std::string& version) {
  return {{"schema", kSchema}, {"tool", "umtet"}, {"version", version}};
}

Json to_json(const Verdict& verdict) { return json_by_fields(verdict); }

Json to_json(const MeshMeasures& measured, const Verdict& verdict) {
  MeshMeasures m = measured;
  Json made = Json::object();
  JsonFields json(made);
  list_blocks(json, m);
  list_order(json, m);
  made.update(to_json(verdict));
  return made;
}

Json to_json(const Certificate& certificate) { return json_by_fields(certificate); }

Certificate certificate_from(const Json& json) {
  try {
    return read_fields<Certificate>(json);
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
  json["second_order"] = check.second_order ? json_by_fields(*check.second_order) : Json(nullptr);
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
  json["places"] = check.defects ? json_by_fields(*check.defects) : Json(nullptr);
  json["fits_psi"] = check.defects ? Json(check.verdict.fits_psi) : Json(nullptr);
  json["verdict"] = check.verdict.word();
  json["n_defects"] = check.verdict.n_defects;
  json["defects"] = check.verdict.defects;
  json["accepted"] = check.verdict.accepted;
  json["reasons"] = check.verdict.reasons;
  return json;
}

}  // namespace umtet
