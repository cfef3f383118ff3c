#include "pipeline/reports/certificate_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "pipeline/reports/certificate_json.h"
#include "pipeline/reports/stage_reports.h"

namespace umtet {
namespace {

/// From the records of the stages.
CertificateRun run_of(const CasePaths& paths, const StageRecord& mesh, std::size_t n_tets,
                      const Parameters& parameters) {
  CertificateRun run;
  const auto add = [&](const StageRecord& record) {
    run.seconds.emplace_back(section_of(record.stage), record.run.seconds);
    run.peak_memory_MB = std::max(run.peak_memory_MB, record.run.peak_memory_MB);
  };
  if (parameters.mesh().implicit.empty()) {
    for (const Stage stage : {Stage::Cloud, Stage::LevelSet}) {
      const StageState state = inspect_stage(paths, stage, parameters.section(section_of(stage)), std::nullopt);
      if (!state.record) continue;
      add(*state.record);
      const double t = state.record->run.seconds;
      if (stage == Stage::LevelSet && t > 0) {
        run.points_per_s = static_cast<double>(level_set_report(*state.record).fit.n_points) / t;
      }
    }
  }
  add(mesh);
  if (const double t = mesh.run.seconds; t > 0) run.tets_per_s = static_cast<double>(n_tets) / t;
  run.threads = mesh.run.threads;
  run.host = mesh.run.host;
  run.date = mesh.run.date;
  return run;
}

/// What to try next when a mesh has failed.
std::string remedy_for(const Certificate& c) {
  const double h = c.measured.mesh.h;
  const std::optional<double>& gate = c.verdict.min_quality_gate;
  if (c.verdict.reasons.size() == 1 && gate && c.measured.mesh.quality.min < *gate) {
    return fmt::format("another --h (this was {:.4g}), which moves the worst tets, or a lower --min-quality", h);
  }
  const std::optional<std::vector<ThinPlace>>& thin = c.measured.resolution.too_thin;
  const std::string enough =
      thin && !thin->empty() ? fmt::format(": {:.3g} shows what is thinnest", thin->front().h_needed) : "";
  return fmt::format("a smaller --h (this was {:.4g}), which resolves more of the shape", h) + enough +
         (c.measured.n_points ? "; where psi itself is wrong there, a finer --spacing" : "");
}

}  // namespace

std::vector<std::string> failures(const SecondOrderReport& report) {
  return failures(report.certificate, report.repairs ? report.repairs->n_mid_sides_put_back : 0);
}

Verdict judge(const MeshCertificate& mesh, std::vector<std::string> reasons, const Parameters& parameters) {
  Verdict verdict;
  verdict.reasons = std::move(reasons);
  const double gate = parameters.output().min_quality;
  if (!(gate > 0)) return verdict;
  verdict.min_quality_gate = gate;
  if (mesh.quality.min < gate) {
    verdict.reasons.push_back(fmt::format("min quality {:.4f} is below the gate of {:.4f}", mesh.quality.min, gate));
  }
  return verdict;
}

Certificate verdict_on(MeshMeasures measured, const Parameters& parameters) {
  Certificate c;
  c.units = units_of(parameters);
  if (const std::int64_t asked = parameters.mesh().tets; asked > 0) c.n_tets_asked = asked;
  c.verdict = judge(measured.mesh, std::exchange(measured.reasons, {}), parameters);
  c.measured = std::move(measured);
  if (!c.verdict.passes()) c.remedy = remedy_for(c);
  return c;
}

std::optional<std::string> units_of(const Parameters& parameters) {
  const std::string& units = parameters.output().units;
  if (units.empty()) return std::nullopt;
  return units;
}

Certificate certificate(const CasePaths& paths, const StageRecord& mesh, const Parameters& parameters) {
  Certificate c = verdict_on(mesh_report(mesh).measured, parameters);
  c.run = run_of(paths, mesh, c.measured.mesh.n_tets, parameters);
  c.run->checksum = seal_of(to_json(c));
  return c;
}

}  // namespace umtet
