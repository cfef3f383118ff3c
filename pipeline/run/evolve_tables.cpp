#include "pipeline/run/evolve_tables.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pipeline/case/artefact.h"
#include "pipeline/output/step_plot.h"
#include "pipeline/run/csv_field.h"

namespace umtet {
namespace {

std::string csv_line(const EvolveStep& step) {
  const std::string name = fmt::format("{},{},", step.file.substr(0, step.file.find('.')), time_text(step.at.t));
  if (!step.made()) return name + fmt::format(",,,,,,,none,{:.3f},{}\n", step.seconds, csv_field(step.error));
  const MeshCertificate& m = step.measured->mesh;
  return name + fmt::format("{},{:.6f},{:.6f},{:.3f},{:.3f},{},{},{},{:.3f},{}\n", m.n_tets, m.quality.min,
                            m.quality.p01, m.quality.dihedral_min_deg, m.quality.dihedral_max_deg,
                            m.boundary.components, m.boundary.genus, step.verdict.word(), step.seconds,
                            csv_field(fmt::format("{}", fmt::join(step.verdict.reasons, "; "))));
}

}  // namespace

void write_tables(const std::filesystem::path& folder, const std::vector<EvolveStep>& steps) {
  std::string csv =
      "step,t,tets,min_q,q_01,dihedral_min_deg,dihedral_max_deg,components,genus,verdict,seconds,reason\n";
  std::string pvd =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "<Collection>\n";
  std::vector<StepQuality> plot;
  for (const EvolveStep& step : steps) {
    if (!step.made() && step.error.empty()) continue;
    csv += csv_line(step);
    plot.push_back({step.at.t, step.made(), 0, 0});
    if (!step.made()) continue;
    plot.back().min = step.measured->mesh.quality.min;
    plot.back().p01 = step.measured->mesh.quality.p01;
    pvd +=
        fmt::format("<DataSet timestep=\"{}\" group=\"\" part=\"0\" file=\"{}\"/>\n", time_text(step.at.t), step.file);
  }
  write_text_artefact(folder / "quality.csv", csv);
  write_text_artefact(folder / "quality.svg", step_plot(plot));
  write_text_artefact(folder / kSeries, pvd + "</Collection>\n</VTKFile>\n");
}

}  // namespace umtet
