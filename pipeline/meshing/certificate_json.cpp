#include "pipeline/meshing/certificate_json.h"

#include <fmt/format.h>

#include <algorithm>

#include "mesh/certify/certificate.h"
#include "pipeline/case/version.h"

namespace umtet {
namespace {

constexpr int kSchema = 1;

/// Times of all stages that made this mesh, from their records.
Json run_of(const CasePaths& paths, const StageRecord& mesh, const Parameters& parameters) {
  Json seconds = Json::object();
  double peak = 0;
  const auto add = [&](const StageRecord& record) {
    seconds[section_of(record.stage)] = record.run.value("seconds", 0.);
    peak = std::max(peak, record.run.value("peak_memory_MB", 0.));
  };
  Json points_per_s = nullptr;
  if (parameters.mesh().implicit.empty()) {
    for (const Stage stage : {Stage::Cloud, Stage::LevelSet}) {
      const StageState state = inspect_stage(paths, stage, parameters.section(section_of(stage)), std::nullopt);
      if (!state.record) continue;
      add(*state.record);
      const double t = state.record->run.value("seconds", 0.);
      if (stage == Stage::LevelSet && t > 0) points_per_s = state.record->numbers.value("n_points", 0.) / t;
    }
  }
  add(mesh);
  const double t = mesh.run.value("seconds", 0.);
  const Json tets_per_s = t > 0 ? Json(mesh.numbers.at("measured").at("n_tets").get<double>() / t) : Json(nullptr);
  return {{"seconds", seconds},
          {"points_per_s", points_per_s},
          {"tets_per_s", tets_per_s},
          {"peak_memory_MB", peak},
          {"threads", mesh.run.value("threads", 0)},
          {"host", mesh.run.value("host", "")},
          {"date", mesh.run.value("date", "")}};
}

/// What to try next when a mesh has failed.
std::string remedy(const Json& c) {
  const double h = c.at("h");
  if (c.at("reasons").size() == 1 && c.at("gates").at("min_quality").is_number() &&
      c.at("quality").at("min").get<double>() < c["gates"]["min_quality"].get<double>()) {
    return fmt::format("another --h (this was {:.4g}), which moves the worst tets, or a lower --min-quality", h);
  }
  return fmt::format("a smaller --h (this was {:.4g}), which resolves more of the shape", h) +
         (c.at("n_points").is_number() ? "; where psi itself is wrong there, a finer --spacing" : "");
}

/// A number of a block, or "-" where the certificate has null.
std::string show(const Json& block, const char* key, const char* format) {
  const auto it = block.find(key);
  if (it == block.end() || !it->is_number()) return "-";
  return fmt::format(fmt::runtime(format), it->get<double>());
}

std::string thousands(std::size_t n) {
  std::string s = std::to_string(n);
  for (int k = static_cast<int>(s.size()) - 3; k > 0; k -= 3) s.insert(s.begin() + k, ',');
  return s;
}

std::string boundary_line(const Json& b) {
  const bool closed = b.value("closed_manifold", false);
  const int n = b.value("components", 0);
  std::string line =
      closed ? fmt::format("closed manifold, {} component{}, genus {}", n, n == 1 ? "" : "s", b.value("genus", 0L))
             : fmt::format("NOT a closed manifold, {} component{}", n, n == 1 ? "" : "s");
  if (b.contains("max_vertex_distance_over_h") && b["max_vertex_distance_over_h"].is_number()) {
    line +=
        fmt::format("; off psi = 0: vertices {} h, face centres {} h, {} of the volume; cos(normals) >= {}",
                    show(b, "max_vertex_distance_over_h", "{:.1e}"), show(b, "max_centroid_distance_over_h", "{:.3f}"),
                    show(b, "gap_over_volume", "{:.1e}"), show(b, "min_cos_normal", "{:.3f}"));
  }
  return line;
}

/// What is true of tets of second order; empty for others.
std::string second_order_lines(const Json& c) {
  if (!c.contains("second_order") || !c["second_order"].is_object()) return "";
  const Json& s = c["second_order"];
  std::string out =
      fmt::format("order 2   {} nodes, volume {}; least Jacobian {} of its mean, {} not positive\n",
                  thousands(s.at("n_nodes")), show(s, "volume", "{:.9g}"), show(s, "min_scaled_jacobian", "{:.3f}"),
                  s.at("n_nonpositive_jacobians").get<std::size_t>());
  if (s.at("max_mid_side_distance_over_h").is_number()) {
    out += fmt::format("          off psi = 0: mid-sides {} h, faces {} h (rms {} h)",
                       show(s, "max_mid_side_distance_over_h", "{:.1e}"), show(s, "max_face_distance_over_h", "{:.1e}"),
                       show(s, "rms_face_distance_over_h", "{:.1e}"));
    const std::size_t n = s.at("n_mid_sides_off_surface");
    out += n > 0 ? fmt::format("; {} mid-sides are NOT on it\n", thousands(n)) : "\n";
  }
  return out;
}

/// Which places are thinner than the mesh can show; empty if there are none.
std::string thin_lines(const Json& c) {
  const Json places = c.value("/resolution/too_thin"_json_pointer, Json::array());
  if (places.empty()) return "";
  const Json& worst = places.front();
  return fmt::format("thin      {} place{} thinner than h can show, the worst ({}, {:.3g}) needs h = {:.3g}\n",
                     places.size(), places.size() == 1 ? " is" : "s are", worst.at("kind").get<std::string>(),
                     worst.at("thickness").get<double>(), worst.at("h_needed").get<double>());
}

}  // namespace

void judge(Json& measured, const Parameters& parameters) {
  std::vector<std::string> reasons = measured.at("reasons");
  measured.erase("reasons");  // they go behind the verdict
  const double gate = parameters.output().min_quality, q = measured.at("quality").at("min");
  measured["gates"] = {{"min_quality", gate > 0 ? Json(gate) : Json(nullptr)}, {"volume_gap", kMostGap}};
  if (gate > 0 && q < gate) reasons.push_back(fmt::format("min quality {:.4f} is below the gate of {:.4f}", q, gate));
  measured["verdict"] = reasons.empty() ? "pass" : "fail";
  measured["reasons"] = reasons;
}

Json verdict_on(const Json& measured, const Parameters& parameters) {
  Json json = {{"schema", kSchema}, {"tool", "umtet"}, {"version", kVersion}};
  const std::string& units = parameters.output().units;
  json["units"] = units.empty() ? Json(nullptr) : Json(units);
  json.update(measured);
  const std::int64_t asked = parameters.mesh().tets;
  json["n_tets_asked"] = asked > 0 ? Json(asked) : Json(nullptr);
  judge(json, parameters);
  json["remedy"] = json["reasons"].empty() ? Json(nullptr) : Json(remedy(json));
  return json;
}

Json certificate(const CasePaths& paths, const StageRecord& mesh, const Parameters& parameters) {
  Json json = verdict_on(mesh.numbers.at("measured"), parameters);
  json["run"] = run_of(paths, mesh, parameters);
  return sealed(json);
}

std::string summary(const Json& c) {
  const Json& q = c.at("quality");
  const std::string unit = c.contains("units") && c["units"].is_string() ? " " + c["units"].get<std::string>() : "";
  std::string out = fmt::format("verdict   {}\n", c.at("verdict").get<std::string>());
  for (const Json& reason : c.at("reasons")) out += fmt::format("          - {}\n", reason.get<std::string>());
  if (c.contains("remedy") && c["remedy"].is_string()) {
    out += fmt::format("          try {}\n", c["remedy"].get<std::string>());
  }
  const bool asked = c.contains("n_tets_asked") && c["n_tets_asked"].is_number();
  out +=
      fmt::format("mesh      {} tets{}, {} vertices, {} boundary faces; h = {}{}, volume {}{}\n",
                  thousands(c.at("n_tets")), asked ? fmt::format(" (asked for {})", thousands(c["n_tets_asked"])) : "",
                  thousands(c.at("n_vertices")), thousands(c.at("boundary").at("n_faces")), show(c, "h", "{:.5g}"),
                  unit, show(c, "volume", "{:.6g}"), unit.empty() ? "" : unit + "^3");
  out += fmt::format("quality   mean ratio min {} | .1 % {} | 1 % {} | mean {}\n", show(q, "min", "{:.4f}"),
                     show(q, "p001", "{:.4f}"), show(q, "p01", "{:.4f}"), show(q, "mean", "{:.4f}"));
  out += fmt::format("          dihedral angles {} to {} degrees, {} inverted tets\n",
                     show(q, "dihedral_min_deg", "{:.1f}"), show(q, "dihedral_max_deg", "{:.1f}"),
                     q.at("n_inverted").get<std::size_t>());
  out += "boundary  " + boundary_line(c.at("boundary")) + "\n" + second_order_lines(c);
  if (c.contains("domain")) {
    const Json& d = c["domain"];
    const int n_pieces = d.at("components_of_zero_set").get<int>();
    out += fmt::format("domain    psi = 0 has {} piece{}, {} dropped", n_pieces, n_pieces == 1 ? "" : "s",
                       d.at("components_dropped").size());
    if (d.at("unsupported_area_fraction").is_number()) {
      out += fmt::format("; {:.2f} % of the surface without samples near it",
                         100 * d["unsupported_area_fraction"].get<double>());
    }
    out += "\n";
  }
  if (c.contains("cloud") && c["cloud"].is_object()) {
    const Json& k = c["cloud"];
    out += fmt::format("cloud     {} samples, noise {} h; distance to the mesh rms {} ({} h), 99 % {} h, max {} h\n",
                       thousands(c.at("n_points")), show(k, "noise_over_h", "{:.3f}"),
                       show(k, "rms_distance", "{:.3g}") + unit, show(k, "rms_distance_over_h", "{:.4f}"),
                       show(k, "p99_distance_over_h", "{:.4f}"), show(k, "max_distance_over_h", "{:.4f}"));
  }
  out += thin_lines(c);
  if (c.contains("run")) {
    out += "time     ";
    for (const auto& [stage, t] : c["run"].at("seconds").items())
      out += fmt::format(" {} {:.2f} s,", stage, t.get<double>());
    out += fmt::format(" peak memory {} MB\n", show(c["run"], "peak_memory_MB", "{:.0f}"));
  }
  return out;
}

}  // namespace umtet
