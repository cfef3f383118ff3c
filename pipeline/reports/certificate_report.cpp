#include "pipeline/reports/certificate_report.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "pipeline/reports/blame.h"
#include "pipeline/reports/certificate_json.h"
#include "pipeline/reports/stage_reports.h"

namespace umtet {
namespace {

/// Collects the data of the runs from the records of the stages.
CertificateRun run_of(const CasePaths& paths, const StageRecord& mesh, std::size_t n_tets,
                      const Parameters& parameters) {
  CertificateRun run;
  const auto add = [&](const StageRecord& record) {
    run.seconds.emplace_back(section_of(record.stage), record.run.seconds);
    run.peak_memory_MB = std::max(run.peak_memory_MB, record.run.peak_memory_MB);
  };
  if (!has_own_psi(parameters.mesh())) {
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

}  // namespace

Certificate verdict_on(MeshMeasures measured, const Parameters& parameters) {
  Certificate c;
  c.units = units_of(parameters);
  if (const std::int64_t asked = parameters.mesh().tets; asked > 0) c.n_tets_asked = asked;
  c.verdict = judge(measured, parameters.output());
  c.measured = std::move(measured);
  if (!c.verdict.passes()) c.blame = blame_for(c);
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
